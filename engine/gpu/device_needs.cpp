#include "engine/gpu/device_needs.h"

#include "engine/base/error.h"

namespace shvr::gpu {

std::optional<std::string> why_too_limited(const VkPhysicalDeviceLimits& limits)
{
    struct Need {
        const char* what;
        uint32_t has, needed;
    };
    const Need needs[] = {
        {"storage images in a kernel", limits.maxPerStageDescriptorStorageImages, MAX_STORAGE_IMAGES},
        {"storage buffers in a kernel", limits.maxPerStageDescriptorStorageBuffers, MAX_STORAGE_BUFFERS},
        {"sampled images in a kernel", limits.maxPerStageDescriptorSampledImages, MAX_SAMPLED_IMAGES},
        {"resources in a kernel", limits.maxPerStageResources,
         MAX_STORAGE_IMAGES + MAX_STORAGE_BUFFERS + MAX_SAMPLED_IMAGES},
        {"bytes of push constants", limits.maxPushConstantsSize, MAX_PUSH_BYTES},
        {"threads in a group", limits.maxComputeWorkGroupInvocations, MAX_GROUP_THREADS}};
    for (const Need& need : needs)
        if (need.has < need.needed)
            return sentence("it allows ", need.has, " ", need.what, "; expected at least ", need.needed);
    return std::nullopt;
}

}  // namespace shvr::gpu
