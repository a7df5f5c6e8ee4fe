// A Vulkan layer for tests: a driver that remembers what it compiled, as those of GPUs do and lavapipe does not. Its
// pipeline caches hold a sum for each pipeline, behind the driver's own head.
//
//   SHVR_CACHE_LOG=FILE          after each pipeline, and at the end of an instance: "compiled N", pipelines that no
//                                cache had; "cached N", that one had; "waited N", made by the thread that made the
//                                instance; "refused N", data of caches that are not what the driver gave
//   SHVR_CACHE_DRIVER=N          the driver says that this is its version
//   SHVR_CACHE_PATIENT=1         samplers, which a program makes before it draws, are made once another thread has made
//                                a pipeline, or after half a minute
//
// Any thread.

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "chain.h"

namespace {

constexpr size_t HEAD_BYTES = 32;

uint64_t mixed(uint64_t sum, const void* data, size_t bytes)
{
    for (size_t i = 0; i < bytes; ++i) sum = (sum ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001b3;
    return sum;
}

struct Driver {
    std::mutex mutex;
    std::thread::id first;
    std::map<VkShaderModule, uint64_t> modules;
    std::map<VkPipelineCache, std::set<uint64_t>> caches;
    uint64_t compiled = 0, cached = 0, waited = 0, refused = 0;
    std::condition_variable is_made_elsewhere;
};
Driver& driver()
{
    static Driver* const one = new Driver;
    return *one;
}

/// Whole at any time. Under the driver's mutex.
void write_log()
{
    const char* const path = std::getenv("SHVR_CACHE_LOG");
    if (!path) return;
    const std::string unfinished = std::string(path) + ".new";
    std::ofstream(unfinished) << "compiled " << driver().compiled << "\ncached " << driver().cached << "\nwaited "
                              << driver().waited << "\nrefused " << driver().refused << '\n';
    std::rename(unfinished.c_str(), path);
}

struct Cache : layers::Unobtrusive {
    using Next = layers::Chain<Cache>;

    static VKAPI_ATTR VkResult VKAPI_CALL create_cache(VkDevice device, const VkPipelineCacheCreateInfo* info,
                                                       const VkAllocationCallbacks* allocator, VkPipelineCache* cache)
    {
        VkPipelineCacheCreateInfo empty = *info;
        empty.initialDataSize = 0;
        const VkResult result =
            Next::next<PFN_vkCreatePipelineCache>(device, "vkCreatePipelineCache")(device, &empty, allocator, cache);
        if (result != VK_SUCCESS) return result;
        const std::lock_guard lock(driver().mutex);
        std::set<uint64_t>& sums = driver().caches[*cache];
        if (info->initialDataSize == 0) return result;
        const auto* const data = static_cast<const unsigned char*>(info->pInitialData);
        std::vector<unsigned char> head(HEAD_BYTES);
        size_t size = HEAD_BYTES;
        Next::next<PFN_vkGetPipelineCacheData>(device, "vkGetPipelineCacheData")(device, *cache, &size, head.data());
        uint64_t sum = 0;
        const size_t count = (info->initialDataSize - HEAD_BYTES) / sizeof sum;
        if (info->initialDataSize < HEAD_BYTES || (info->initialDataSize - HEAD_BYTES) % sizeof sum != 0 ||
            std::memcmp(data, head.data(), HEAD_BYTES) != 0) {
            ++driver().refused;
            return result;
        }
        for (size_t i = 0; i < count; ++i) {
            std::memcpy(&sum, data + HEAD_BYTES + i * sizeof sum, sizeof sum);
            sums.insert(sum);
        }
        return result;
    }

    static VKAPI_ATTR VkResult VKAPI_CALL data_of(VkDevice device, VkPipelineCache cache, size_t* size, void* data)
    {
        const std::lock_guard lock(driver().mutex);
        const std::set<uint64_t>& sums = driver().caches[cache];
        const size_t bytes = HEAD_BYTES + sums.size() * sizeof(uint64_t);
        if (!data) {
            *size = bytes;
            return VK_SUCCESS;
        }
        if (*size < bytes) return VK_INCOMPLETE;
        *size = HEAD_BYTES;
        Next::next<PFN_vkGetPipelineCacheData>(device, "vkGetPipelineCacheData")(device, cache, size, data);
        auto* at = static_cast<unsigned char*>(data) + HEAD_BYTES;
        for (const uint64_t sum : sums)
            at = static_cast<unsigned char*>(std::memcpy(at, &sum, sizeof sum)) + sizeof sum;
        *size = bytes;
        return VK_SUCCESS;
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create_module(VkDevice device, const VkShaderModuleCreateInfo* info,
                                                        const VkAllocationCallbacks* allocator, VkShaderModule* module)
    {
        const VkResult result =
            Next::next<PFN_vkCreateShaderModule>(device, "vkCreateShaderModule")(device, info, allocator, module);
        const std::lock_guard lock(driver().mutex);
        if (result == VK_SUCCESS) driver().modules[*module] = mixed(0, info->pCode, info->codeSize);
        return result;
    }

    static uint64_t sum_of(const VkComputePipelineCreateInfo& info)
    {
        uint64_t sum = driver().modules.at(info.stage.module);
        const VkSpecializationInfo* const constants = info.stage.pSpecializationInfo;
        if (!constants) return sum;
        for (uint32_t i = 0; i < constants->mapEntryCount; ++i)
            sum = mixed(sum, &constants->pMapEntries[i].constantID, sizeof(uint32_t));
        return mixed(sum, constants->pData, constants->dataSize);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                           const VkComputePipelineCreateInfo* infos,
                                                           const VkAllocationCallbacks* allocator, VkPipeline* made)
    {
        const VkResult result = Next::next<PFN_vkCreateComputePipelines>(device, "vkCreateComputePipelines")(
            device, cache, count, infos, allocator, made);
        if (result != VK_SUCCESS) return result;
        const std::lock_guard lock(driver().mutex);
        for (uint32_t i = 0; i < count; ++i) {
            const bool was_there = cache && !driver().caches[cache].insert(sum_of(infos[i])).second;
            ++(was_there ? driver().cached : driver().compiled);
            if (std::this_thread::get_id() == driver().first)
                ++driver().waited;
            else
                driver().is_made_elsewhere.notify_all();
            for (const auto* next = static_cast<const VkBaseInStructure*>(infos[i].pNext); next; next = next->pNext)
                if (next->sType == VK_STRUCTURE_TYPE_PIPELINE_CREATION_FEEDBACK_CREATE_INFO)
                    reinterpret_cast<const VkPipelineCreationFeedbackCreateInfo*>(next)
                        ->pPipelineCreationFeedback->flags =
                        VK_PIPELINE_CREATION_FEEDBACK_VALID_BIT |
                        (was_there ? VK_PIPELINE_CREATION_FEEDBACK_APPLICATION_PIPELINE_CACHE_HIT_BIT : 0);
        }
        write_log();
        return result;
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create_sampler(VkDevice device, const VkSamplerCreateInfo* info,
                                                         const VkAllocationCallbacks* allocator, VkSampler* sampler)
    {
        if (std::getenv("SHVR_CACHE_PATIENT")) {
            std::unique_lock lock(driver().mutex);
            driver().is_made_elsewhere.wait_for(lock, std::chrono::seconds(30),
                                                [] { return driver().compiled + driver().cached > driver().waited; });
        }
        return Next::next<PFN_vkCreateSampler>(device, "vkCreateSampler")(device, info, allocator, sampler);
    }

    static VKAPI_ATTR void VKAPI_CALL properties2(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* properties)
    {
        Next::next_of_instance<PFN_vkGetPhysicalDeviceProperties2>(physical, "vkGetPhysicalDeviceProperties2")(
            physical, properties);
        if (const char* const version = std::getenv("SHVR_CACHE_DRIVER"))
            properties->properties.driverVersion = uint32_t(std::strtoul(version, nullptr, 10));
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
        if (is("vkCreatePipelineCache")) return reinterpret_cast<PFN_vkVoidFunction>(&create_cache);
        if (is("vkGetPipelineCacheData")) return reinterpret_cast<PFN_vkVoidFunction>(&data_of);
        if (is("vkCreateShaderModule")) return reinterpret_cast<PFN_vkVoidFunction>(&create_module);
        if (is("vkCreateComputePipelines")) return reinterpret_cast<PFN_vkVoidFunction>(&create_pipelines);
        if (is("vkCreateSampler")) return reinterpret_cast<PFN_vkVoidFunction>(&create_sampler);
        if (is("vkGetPhysicalDeviceProperties2")) return reinterpret_cast<PFN_vkVoidFunction>(&properties2);
        return nullptr;
    }
    static void instance_made(VkInstance) { driver().first = std::this_thread::get_id(); }
    static void instance_goes(VkInstance)
    {
        const std::lock_guard lock(driver().mutex);
        write_log();
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL cache_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Cache>::negotiate(interface);
}
