#include "engine/gpu/device_needs.h"

#include "engine/base/error.h"

namespace shvr::gpu {

std::optional<std::string> why_too_limited(const DeviceHas& has)
{
    const VkPhysicalDeviceLimits& limits = has.limits;
    struct Need {
        const char* what;
        uint64_t has, needed;
    };
    const Need needs[] = {
        {"storage images in a kernel", limits.maxPerStageDescriptorStorageImages, MAX_STORAGE_IMAGES},
        {"storage buffers in a kernel", limits.maxPerStageDescriptorStorageBuffers, MAX_STORAGE_BUFFERS},
        {"sampled images in a kernel", limits.maxPerStageDescriptorSampledImages, MAX_SAMPLED_IMAGES},
        {"resources in a kernel", limits.maxPerStageResources,
         MAX_STORAGE_IMAGES + MAX_STORAGE_BUFFERS + MAX_SAMPLED_IMAGES},
        {"bytes of push constants", limits.maxPushConstantsSize, MAX_PUSH_BYTES},
        {"threads in a group", limits.maxComputeWorkGroupInvocations, MAX_GROUP_THREADS},
        {"bytes that a group shares", limits.maxComputeSharedMemorySize, MAX_SHARED_BYTES},
        {"bytes in a storage buffer", limits.maxStorageBufferRange, MIN_BUFFER_BYTES},
        {"bytes in a buffer", has.max_buffer_bytes, MIN_BUFFER_BYTES}};
    for (const Need& need : needs)
        if (need.has < need.needed)
            return sentence("it allows ", need.has, " ", need.what, "; expected at least ", need.needed);
    constexpr VkFormatFeatureFlags STORED =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_TRANSFER_SRC_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT;
    if ((has.r8_uint & STORED) != STORED)
        return "R8_UINT storage images cannot be read and written; expected a driver that can do so";
    if ((has.r32_uint & STORED) != STORED)
        return "R32_UINT storage images cannot be read and written; expected a driver that can do so";
    return std::nullopt;
}

}  // namespace shvr::gpu
