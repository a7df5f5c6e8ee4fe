// What is asked of a device before it is used (engine/gpu/device_needs.h) is what the kernels need, and no more.

#include "engine/gpu/device_needs.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/gpu/embedded_kernels.h"
#include "engine/gpu/kernel.h"

using namespace shvr;
using namespace shvr::gpu;

TEST_CASE("a device is asked for what the kernel that needs most of it needs")
{
    uint32_t images = 0, buffers = 0, sampled = 0, threads = 0, push = 0;
    for (const EmbeddedKernel& kernel : embedded_kernels()) {
        const KernelInterface found = reflect(kernel.name, {kernel.words, kernel.word_count});
        const auto count = [&](VkDescriptorType type) {
            return uint32_t(std::ranges::count(found.slots, type, &KernelInterface::Slot::type));
        };
        images = std::max(images, count(VK_DESCRIPTOR_TYPE_STORAGE_IMAGE));
        buffers = std::max(buffers, count(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER));
        sampled = std::max(sampled, count(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER));
        push = std::max(push, found.push_bytes);
        threads = std::max(threads, found.local_size[0] * found.local_size[1] * found.local_size[2]);
    }
    CHECK(images == MAX_STORAGE_IMAGES);
    CHECK(buffers == MAX_STORAGE_BUFFERS);
    CHECK(sampled == MAX_SAMPLED_IMAGES);
    CHECK(push <= MAX_PUSH_BYTES);
    CHECK(threads <= MAX_GROUP_THREADS);
}

TEST_CASE("a device that has less is refused by what it lacks")
{
    VkPhysicalDeviceLimits limits{};
    limits.maxPerStageDescriptorStorageImages = MAX_STORAGE_IMAGES;
    limits.maxPerStageDescriptorStorageBuffers = MAX_STORAGE_BUFFERS;
    limits.maxPerStageDescriptorSampledImages = MAX_SAMPLED_IMAGES;
    limits.maxPerStageResources = 128;
    limits.maxPushConstantsSize = MAX_PUSH_BYTES;
    limits.maxComputeWorkGroupInvocations = MAX_GROUP_THREADS;
    CHECK(!why_too_limited(limits));
    limits.maxPerStageDescriptorStorageImages = 4;  // the least that Vulkan allows
    CHECK(why_too_limited(limits) ==
          sentence("it allows 4 storage images in a kernel; expected at least ", MAX_STORAGE_IMAGES));
}
