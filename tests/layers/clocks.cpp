// A Vulkan layer for tests: timestamps of a device whose speed the test chooses. Its clock advances only
// with dispatches, as they are recorded, so that times are exact.
//
//   SHVR_CLOCKS=N                nanoseconds that a workgroup takes, from now on
//   SHVR_CLOCKS_EARLY=N          nanoseconds by which stamps at the start of passes are early, from now on
//   SHVR_CLOCKS_LOG=FILE         at the end: "longest N", the nanoseconds of the instance's longest submission, by its
//                                dispatches
//
// For devices whose timestamp ticks are nanoseconds. One thread.

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <utility>

#include "chain.h"

namespace {

uint64_t number_of(const char* variable)
{
    const char* const text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : 0;
}

uint64_t now_ns = 1'000'000'000;
std::map<std::pair<VkQueryPool, uint32_t>, uint64_t> stamps;
std::map<VkCommandBuffer, uint64_t> recorded_ns;
uint64_t longest_ns = 0;

void take(VkCommandBuffer commands, uint64_t groups)
{
    const uint64_t ns = groups * number_of("SHVR_CLOCKS");
    now_ns += ns;
    recorded_ns[commands] += ns;
}

struct Clocks : layers::Unobtrusive {
    using Next = layers::Chain<Clocks>;

    static VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z)
    {
        take(commands, uint64_t{x} * y * z);
        Next::next<PFN_vkCmdDispatch>(commands, "vkCmdDispatch")(commands, x, y, z);
    }
    static VKAPI_ATTR void VKAPI_CALL dispatch_base(VkCommandBuffer commands, uint32_t at_x, uint32_t at_y,
                                                    uint32_t at_z, uint32_t x, uint32_t y, uint32_t z)
    {
        take(commands, uint64_t{x} * y * z);
        Next::next<PFN_vkCmdDispatchBase>(commands, "vkCmdDispatchBase")(commands, at_x, at_y, at_z, x, y, z);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL begin(VkCommandBuffer commands, const VkCommandBufferBeginInfo* info)
    {
        recorded_ns[commands] = 0;
        return Next::next<PFN_vkBeginCommandBuffer>(commands, "vkBeginCommandBuffer")(commands, info);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo2* infos,
                                                 VkFence fence)
    {
        for (uint32_t i = 0; i < count; ++i) {
            uint64_t ns = 0;
            for (uint32_t k = 0; k < infos[i].commandBufferInfoCount; ++k)
                ns += recorded_ns[infos[i].pCommandBufferInfos[k].commandBuffer];
            longest_ns = std::max(longest_ns, ns);
        }
        return Next::next<PFN_vkQueueSubmit2>(queue, "vkQueueSubmit2")(queue, count, infos, fence);
    }
    /// Pairs of stamps: starts have even numbers.
    static VKAPI_ATTR void VKAPI_CALL stamp(VkCommandBuffer commands, VkPipelineStageFlags2 stage, VkQueryPool pool,
                                            uint32_t query)
    {
        stamps[{pool, query}] = now_ns - (query % 2 == 0 ? number_of("SHVR_CLOCKS_EARLY") : 0);
        Next::next<PFN_vkCmdWriteTimestamp2>(commands, "vkCmdWriteTimestamp2")(commands, stage, pool, query);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL results(VkDevice device, VkQueryPool pool, uint32_t first, uint32_t count,
                                                  size_t bytes, void* data, VkDeviceSize stride,
                                                  VkQueryResultFlags flags)
    {
        const VkResult result = Next::next<PFN_vkGetQueryPoolResults>(device, "vkGetQueryPoolResults")(
            device, pool, first, count, bytes, data, stride, flags);
        for (uint32_t i = 0; i < count; ++i)
            std::memcpy(static_cast<char*>(data) + i * stride, &stamps[{pool, first + i}], sizeof(uint64_t));
        return result;
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
        if (is("vkCmdDispatch")) return reinterpret_cast<PFN_vkVoidFunction>(&dispatch);
        if (is("vkCmdDispatchBase")) return reinterpret_cast<PFN_vkVoidFunction>(&dispatch_base);
        if (is("vkBeginCommandBuffer")) return reinterpret_cast<PFN_vkVoidFunction>(&begin);
        if (is("vkQueueSubmit2")) return reinterpret_cast<PFN_vkVoidFunction>(&submit);
        if (is("vkCmdWriteTimestamp2")) return reinterpret_cast<PFN_vkVoidFunction>(&stamp);
        if (is("vkGetQueryPoolResults")) return reinterpret_cast<PFN_vkVoidFunction>(&results);
        return nullptr;
    }
    static void instance_made(VkInstance) { longest_ns = 0; }
    static void instance_goes(VkInstance)
    {
        if (const char* const path = std::getenv("SHVR_CLOCKS_LOG")) std::ofstream(path) << "longest " << longest_ns;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL clocks_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Clocks>::negotiate(interface);
}
