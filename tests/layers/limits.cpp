// A Vulkan layer for tests: the device says that it is another one, with other limits, and keeps to them.
//
//   SHVR_LIMITS=intel            a name of records.h
//   SHVR_LIMITS_LOG=FILE         requests beyond the limits, a line each
//
// Some drivers make a dispatch of each slice of each region of a copy: a copy of more than 256 regions is logged, too.
// Valid requests that drivers may refuse fail as in a driver: memory from a full heap, allocations beyond their number.
// Invalid requests fail with VK_ERROR_INITIALIZATION_FAILED and are logged: images and buffers that are too large,
// mapping memory that cannot be mapped, unsupported timestamps and memory priorities. Only logged: memory without a
// priority where priorities are supported, and a device without robust access to images (kernels read outside them) or
// to buffers. All memory types are the driver's first one that a host can map. Any thread.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "chain.h"
#include "records.h"

namespace {

using layers::chained;
using layers::Record;

const Record* current = nullptr;

/// The record of the instance that was made last: tests make one after another.
const Record& record()
{
    return *current;
}

void choose_record()
{
    const char* const name = std::getenv("SHVR_LIMITS");
    current = nullptr;
    for (const Record& one : layers::records())
        if (name && one.name == name) current = &one;
    if (current) return;
    std::fprintf(stderr, "SHVR_LIMITS is '%s', which tests/layers/records.h does not have\n", name ? name : "");
    std::abort();
}

VkResult violated(const std::string& what)
{
    if (const char* const path = std::getenv("SHVR_LIMITS_LOG")) std::ofstream(path, std::ios::app) << what << '\n';
    return VK_ERROR_INITIALIZATION_FAILED;
}

struct Used {
    std::mutex mutex;
    struct Allocation {
        uint32_t type;
        uint64_t bytes;
    };
    std::unordered_map<uint64_t, Allocation> allocations;
    uint64_t of_heaps[VK_MAX_MEMORY_HEAPS]{};
};
Used& used()
{
    static Used* const one = new Used;
    return *one;
}

struct Limits : layers::Unobtrusive {
    using Next = layers::Chain<Limits>;

    static void limit(VkPhysicalDeviceProperties& properties)
    {
        std::snprintf(properties.deviceName, sizeof properties.deviceName, "%s", record().device);
        properties.deviceType = record().type;
        VkPhysicalDeviceLimits& limits = properties.limits;
        limits.maxImageDimension3D = record().max_side_3d;
        limits.maxImageDimension2D = record().max_side_2d;
        limits.maxStorageBufferRange = record().max_storage_range;
        limits.maxMemoryAllocationCount = record().max_allocations;
        limits.maxPerStageDescriptorStorageImages =
            std::min(limits.maxPerStageDescriptorStorageImages, record().max_storage_images);
        limits.timestampPeriod = record().timestamp_period;
        limits.timestampComputeAndGraphics = record().timestamp_bits > 0;
    }
    static VKAPI_ATTR void VKAPI_CALL properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* found)
    {
        Next::next_of_instance<PFN_vkGetPhysicalDeviceProperties>(physical, "vkGetPhysicalDeviceProperties")(physical,
                                                                                                             found);
        limit(*found);
    }
    static VKAPI_ATTR void VKAPI_CALL properties2(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* found)
    {
        Next::next_of_instance<PFN_vkGetPhysicalDeviceProperties2>(physical, "vkGetPhysicalDeviceProperties2")(physical,
                                                                                                               found);
        limit(found->properties);
        if (auto* const of = chained<VkPhysicalDeviceMaintenance3Properties>(
                found, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES))
            of->maxMemoryAllocationSize = record().max_allocation;
        if (auto* const of = chained<VkPhysicalDeviceMaintenance4Properties>(
                found, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES))
            of->maxBufferSize = record().max_buffer;
    }
    static VKAPI_ATTR void VKAPI_CALL format_properties(VkPhysicalDevice physical, VkFormat format,
                                                        VkFormatProperties* found)
    {
        Next::next_of_instance<PFN_vkGetPhysicalDeviceFormatProperties>(
            physical, "vkGetPhysicalDeviceFormatProperties")(physical, format, found);
        if (format == VK_FORMAT_R16_UNORM && !record().linear_r16)
            found->optimalTilingFeatures &= ~VkFormatFeatureFlags{VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT};
    }
    static VKAPI_ATTR VkResult VKAPI_CALL image_format_properties(VkPhysicalDevice physical, VkFormat format,
                                                                  VkImageType type, VkImageTiling tiling,
                                                                  VkImageUsageFlags usage, VkImageCreateFlags flags,
                                                                  VkImageFormatProperties* found)
    {
        const VkResult result = Next::next_of_instance<PFN_vkGetPhysicalDeviceImageFormatProperties>(
            physical, "vkGetPhysicalDeviceImageFormatProperties")(physical, format, type, tiling, usage, flags, found);
        if (result != VK_SUCCESS) return result;
        const uint32_t side = type == VK_IMAGE_TYPE_3D ? record().max_side_3d : record().max_side_2d;
        found->maxExtent = {side, side, type == VK_IMAGE_TYPE_3D ? side : 1};
        found->maxResourceSize = record().max_image;
        return result;
    }
    static VKAPI_ATTR void VKAPI_CALL queue_families(VkPhysicalDevice physical, uint32_t* count,
                                                     VkQueueFamilyProperties* found)
    {
        Next::next_of_instance<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
            physical, "vkGetPhysicalDeviceQueueFamilyProperties")(physical, count, found);
        for (uint32_t i = 0; found && i < *count; ++i) found[i].timestampValidBits = record().timestamp_bits;
    }

    // ---- Memory

    static VKAPI_ATTR void VKAPI_CALL memory_properties(VkPhysicalDevice, VkPhysicalDeviceMemoryProperties* found)
    {
        *found = {};
        found->memoryHeapCount = uint32_t(record().heaps.size());
        std::ranges::copy(record().heaps, found->memoryHeaps);
        found->memoryTypeCount = uint32_t(record().types.size());
        std::ranges::copy(record().types, found->memoryTypes);
    }
    static VKAPI_ATTR void VKAPI_CALL memory_properties2(VkPhysicalDevice physical,
                                                         VkPhysicalDeviceMemoryProperties2* found)
    {
        memory_properties(physical, &found->memoryProperties);
        auto* const budget = chained<VkPhysicalDeviceMemoryBudgetPropertiesEXT>(
            found, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT);
        if (!budget || !record().tells_budget) return;
        const std::lock_guard lock(used().mutex);
        for (size_t i = 0; i < record().heaps.size(); ++i) {
            budget->heapBudget[i] = record().heaps[i].size / 10 * 9;
            budget->heapUsage[i] = used().of_heaps[i];
        }
    }
    /// Extensions that the record has or has not, whatever the driver has.
    static bool is_ours(const char* extension)
    {
        return std::strcmp(extension, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME) == 0 ||
               std::strcmp(extension, VK_EXT_DEVICE_FAULT_EXTENSION_NAME) == 0 ||
               std::strcmp(extension, VK_EXT_MEMORY_PRIORITY_EXTENSION_NAME) == 0;
    }
    static VKAPI_ATTR VkResult VKAPI_CALL extensions(VkPhysicalDevice physical, const char* layer, uint32_t* count,
                                                     VkExtensionProperties* found)
    {
        const auto next = Next::next_of_instance<PFN_vkEnumerateDeviceExtensionProperties>(
            physical, "vkEnumerateDeviceExtensionProperties");
        uint32_t there = 0;
        next(physical, layer, &there, nullptr);
        std::vector<VkExtensionProperties> all(there);
        next(physical, layer, &there, all.data());
        std::erase_if(all, [](const VkExtensionProperties& one) { return is_ours(one.extensionName); });
        if (record().tells_budget) all.push_back({VK_EXT_MEMORY_BUDGET_EXTENSION_NAME, 1});
        if (record().tells_faults) all.push_back({VK_EXT_DEVICE_FAULT_EXTENSION_NAME, 1});
        if (record().has_memory_priority) all.push_back({VK_EXT_MEMORY_PRIORITY_EXTENSION_NAME, 1});
        return layers::answer(all, count, found);
    }
    static uint32_t all_types() { return (1u << record().types.size()) - 1; }
    static VKAPI_ATTR void VKAPI_CALL buffer_needs(VkDevice device, VkBuffer buffer, VkMemoryRequirements* needs)
    {
        Next::next<PFN_vkGetBufferMemoryRequirements>(device, "vkGetBufferMemoryRequirements")(device, buffer, needs);
        needs->memoryTypeBits = all_types();
    }
    static VKAPI_ATTR void VKAPI_CALL image_needs(VkDevice device, VkImage image, VkMemoryRequirements* needs)
    {
        Next::next<PFN_vkGetImageMemoryRequirements>(device, "vkGetImageMemoryRequirements")(device, image, needs);
        needs->memoryTypeBits = all_types();
    }
    static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkDeviceMemory* memory)
    {
        const uint32_t type = info->memoryTypeIndex;
        if (type >= record().types.size()) return violated("memory of a type that there is not");
        if (info->allocationSize > record().max_allocation)
            return violated("an allocation of " + std::to_string(info->allocationSize) + " bytes");
        const uint32_t heap = record().types[type].heapIndex;
        {
            const std::lock_guard lock(used().mutex);
            if (used().allocations.size() >= record().max_allocations) return VK_ERROR_TOO_MANY_OBJECTS;
            if (used().of_heaps[heap] + info->allocationSize > record().heaps[heap].size)
                return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        }
        const auto* const priority = chained<VkMemoryPriorityAllocateInfoEXT>(
            const_cast<void*>(info->pNext), VK_STRUCTURE_TYPE_MEMORY_PRIORITY_ALLOCATE_INFO_EXT);
        if (!priority && record().has_memory_priority)
            violated("memory without a priority");  // a device may be told none
        if (priority && !record().has_memory_priority) return violated("a priority of memory");
        if (priority && !(priority->priority >= 0.0f && priority->priority <= 1.0f))
            return violated("a priority of " + std::to_string(priority->priority));
        VkMemoryAllocateInfo real = *info;
        real.pNext = nullptr;
        real.memoryTypeIndex = 0;
        const VkResult result =
            Next::next<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, &real, allocator, memory);
        if (result != VK_SUCCESS) return result;
        const std::lock_guard lock(used().mutex);
        used().allocations[uint64_t(*memory)] = {type, info->allocationSize};
        used().of_heaps[heap] += info->allocationSize;
        return result;
    }
    static VKAPI_ATTR void VKAPI_CALL free_memory(VkDevice device, VkDeviceMemory memory,
                                                  const VkAllocationCallbacks* allocator)
    {
        {
            const std::lock_guard lock(used().mutex);
            if (const auto found = used().allocations.find(uint64_t(memory)); found != used().allocations.end()) {
                used().of_heaps[record().types[found->second.type].heapIndex] -= found->second.bytes;
                used().allocations.erase(found);
            }
        }
        Next::next<PFN_vkFreeMemory>(device, "vkFreeMemory")(device, memory, allocator);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL map(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset,
                                              VkDeviceSize size, VkMemoryMapFlags flags, void** mapped)
    {
        {
            const std::lock_guard lock(used().mutex);
            const auto found = used().allocations.find(uint64_t(memory));
            if (found == used().allocations.end() ||
                !(record().types[found->second.type].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT))
                return violated("memory mapped that the host cannot see");
        }
        return Next::next<PFN_vkMapMemory>(device, "vkMapMemory")(device, memory, offset, size, flags, mapped);
    }

    // ---- Resources

    static VKAPI_ATTR VkResult VKAPI_CALL create_image(VkDevice device, const VkImageCreateInfo* info,
                                                       const VkAllocationCallbacks* allocator, VkImage* image)
    {
        const VkExtent3D& extent = info->extent;
        const uint32_t side = info->imageType == VK_IMAGE_TYPE_3D ? record().max_side_3d : record().max_side_2d;
        if (std::max({extent.width, extent.height, extent.depth}) > side)
            return violated("an image of " + std::to_string(extent.width) + " x " + std::to_string(extent.height) +
                            " x " + std::to_string(extent.depth));
        return Next::next<PFN_vkCreateImage>(device, "vkCreateImage")(device, info, allocator, image);
    }
    static VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo* info,
                                                        const VkAllocationCallbacks* allocator, VkBuffer* buffer)
    {
        if (info->size > record().max_buffer) return violated("a buffer of " + std::to_string(info->size) + " bytes");
        return Next::next<PFN_vkCreateBuffer>(device, "vkCreateBuffer")(device, info, allocator, buffer);
    }
    // ---- Commands

    static void check_regions(uint32_t count)
    {
        constexpr uint32_t MOST = 256;
        if (count > MOST) violated("a copy of " + std::to_string(count) + " regions");
    }
    static VKAPI_ATTR void VKAPI_CALL copy_buffer(VkCommandBuffer commands, VkBuffer from, VkBuffer to, uint32_t count,
                                                  const VkBufferCopy* regions)
    {
        check_regions(count);
        Next::next<PFN_vkCmdCopyBuffer>(commands, "vkCmdCopyBuffer")(commands, from, to, count, regions);
    }
    static VKAPI_ATTR void VKAPI_CALL copy_to_image(VkCommandBuffer commands, VkBuffer from, VkImage to,
                                                    VkImageLayout layout, uint32_t count,
                                                    const VkBufferImageCopy* regions)
    {
        check_regions(count);
        Next::next<PFN_vkCmdCopyBufferToImage>(commands, "vkCmdCopyBufferToImage")(commands, from, to, layout, count,
                                                                                   regions);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create_queries(VkDevice device, const VkQueryPoolCreateInfo* info,
                                                         const VkAllocationCallbacks* allocator, VkQueryPool* pool)
    {
        if (info->queryType == VK_QUERY_TYPE_TIMESTAMP && record().timestamp_bits == 0) return violated("timestamps");
        return Next::next<PFN_vkCreateQueryPool>(device, "vkCreateQueryPool")(device, info, allocator, pool);
    }
    /// Ticks of the record's length, whose counter overflows soon.
    static VKAPI_ATTR VkResult VKAPI_CALL query_results(VkDevice device, VkQueryPool pool, uint32_t first,
                                                        uint32_t count, size_t bytes, void* data, VkDeviceSize stride,
                                                        VkQueryResultFlags flags)
    {
        const VkResult result = Next::next<PFN_vkGetQueryPoolResults>(device, "vkGetQueryPoolResults")(
            device, pool, first, count, bytes, data, stride, flags);
        if (result != VK_SUCCESS || !(flags & VK_QUERY_RESULT_64_BIT) || record().timestamp_bits == 0) return result;
        const uint32_t bits = record().timestamp_bits;
        const uint64_t mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
        for (uint32_t i = 0; i < count; ++i) {
            auto* const ticks = reinterpret_cast<uint64_t*>(static_cast<std::byte*>(data) + i * stride);
            static const uint64_t begin = *ticks;
            const double since_ns = *ticks >= begin ? double(*ticks - begin) : -double(begin - *ticks);
            *ticks = (uint64_t(int64_t(since_ns / double(record().timestamp_period))) - 1000) & mask;
        }
        return result;
    }

    // ---- A lost device (tests/layers/faults.cpp) reports one address and one code

    static VKAPI_ATTR VkResult VKAPI_CALL fault(VkDevice, VkDeviceFaultCountsEXT* counts, VkDeviceFaultInfoEXT* info)
    {
        const bool has_room = counts->addressInfoCount > 0 && counts->vendorInfoCount > 0;
        *counts = {.sType = counts->sType, .addressInfoCount = 1, .vendorInfoCount = 1, .vendorBinarySize = 0};
        if (!info) return VK_SUCCESS;
        if (!has_room) return VK_INCOMPLETE;
        std::snprintf(info->description, sizeof info->description, "page fault");
        info->pAddressInfos[0] = {.addressType = VK_DEVICE_FAULT_ADDRESS_TYPE_READ_INVALID_EXT,
                                  .reportedAddress = 0xfeed000,
                                  .addressPrecision = 4096};
        info->pVendorInfos[0] = {.description = "channel", .vendorFaultCode = 31, .vendorFaultData = 0};
        return VK_SUCCESS;
    }

    static PFN_vkVoidFunction hook(const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
#define SHVR_HOOK(call, function)                                                                                      \
    if (is(#call)) return reinterpret_cast<PFN_vkVoidFunction>(static_cast<PFN_##call>(&function));
        SHVR_HOOK(vkGetPhysicalDeviceProperties, properties)
        SHVR_HOOK(vkGetPhysicalDeviceProperties2, properties2)
        SHVR_HOOK(vkGetPhysicalDeviceFormatProperties, format_properties)
        SHVR_HOOK(vkGetPhysicalDeviceImageFormatProperties, image_format_properties)
        SHVR_HOOK(vkGetPhysicalDeviceQueueFamilyProperties, queue_families)
        SHVR_HOOK(vkGetPhysicalDeviceMemoryProperties, memory_properties)
        SHVR_HOOK(vkGetPhysicalDeviceMemoryProperties2, memory_properties2)
        SHVR_HOOK(vkEnumerateDeviceExtensionProperties, extensions)
        SHVR_HOOK(vkGetBufferMemoryRequirements, buffer_needs)
        SHVR_HOOK(vkGetImageMemoryRequirements, image_needs)
        SHVR_HOOK(vkAllocateMemory, allocate)
        SHVR_HOOK(vkFreeMemory, free_memory)
        SHVR_HOOK(vkMapMemory, map)
        SHVR_HOOK(vkCreateImage, create_image)
        SHVR_HOOK(vkCreateBuffer, create_buffer)
        SHVR_HOOK(vkCreateQueryPool, create_queries)
        SHVR_HOOK(vkGetQueryPoolResults, query_results)
        SHVR_HOOK(vkCmdCopyBuffer, copy_buffer)
        SHVR_HOOK(vkCmdCopyBufferToImage, copy_to_image)
        SHVR_HOOK(vkGetDeviceFaultInfoEXT, fault)
#undef SHVR_HOOK
        return nullptr;
    }
    static void instance_made(VkInstance)
    {
        choose_record();
    }
    /// Without the extensions that the driver may not have, and what goes with them.
    static VkDeviceCreateInfo device_info(const VkDeviceCreateInfo& info)
    {
        const auto* const asked = chained<VkPhysicalDeviceVulkan13Features>(
            const_cast<void*>(info.pNext), VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
        if (!asked || !asked->robustImageAccess) violated("reads beside images, as robustImageAccess is off");
        const auto* const features = chained<VkPhysicalDeviceFeatures2>(const_cast<void*>(info.pNext),
                                                                        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
        if (!features || !features->features.robustBufferAccess)
            violated("accesses beside buffers, as robustBufferAccess is off");
        static thread_local std::vector<const char*> kept;
        kept.assign(info.ppEnabledExtensionNames, info.ppEnabledExtensionNames + info.enabledExtensionCount);
        std::erase_if(kept, is_ours);
        const auto is_added = [](const VkBaseOutStructure* one) {
            return one && (one->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FAULT_FEATURES_EXT ||
                           one->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PRIORITY_FEATURES_EXT);
        };
        for (auto* at = static_cast<VkBaseOutStructure*>(const_cast<void*>(info.pNext)); at; at = at->pNext)
            while (is_added(at->pNext)) at->pNext = at->pNext->pNext;
        VkDeviceCreateInfo changed = info;
        changed.enabledExtensionCount = uint32_t(kept.size());
        changed.ppEnabledExtensionNames = kept.data();
        return changed;
    }
};

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL limits_negotiate(VkNegotiateLayerInterface* interface)
{
    return layers::Chain<Limits>::negotiate(interface);
}
