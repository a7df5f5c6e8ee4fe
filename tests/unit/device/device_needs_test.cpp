// Requirements on a device, checked before its use (engine/gpu/device_needs.h), are those of the kernels and no more.

#include "engine/gpu/device_needs.h"

#include <algorithm>
#include <map>
#include <span>

#include <doctest/doctest.h>

#include "engine/gpu/embedded_kernels.h"
#include "engine/gpu/kernel.h"

using namespace shvr;
using namespace shvr::gpu;

namespace {

/// Shared memory of a workgroup of the kernel, by its SPIR-V: variables of the storage class Workgroup.
uint32_t shared_bytes(std::span<const uint32_t> spirv)
{
    enum : uint32_t { TYPE_INT = 21, TYPE_FLOAT = 22, TYPE_VECTOR = 23, TYPE_ARRAY = 28, TYPE_POINTER = 32 };
    enum : uint32_t { CONSTANT = 43, SPEC_CONSTANT = 50, VARIABLE = 59, WORKGROUP = 4 };
    std::map<uint32_t, uint32_t> bytes, values;
    uint32_t sum = 0;
    for (size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
        const uint32_t* const word = &spirv[at];
        switch (word[0] & 0xffff) {
            case TYPE_INT:
            case TYPE_FLOAT: bytes[word[1]] = word[2] / 8; break;
            case TYPE_VECTOR:  // of truth values, which are in no group, or of numbers
                if (bytes.contains(word[2])) bytes[word[1]] = bytes[word[2]] * word[3];
                break;
            case TYPE_ARRAY:  // of other things, or where the length is not known: they are in no group
                if (bytes.contains(word[2]) && values.contains(word[3]))
                    bytes[word[1]] = bytes[word[2]] * values[word[3]];
                break;
            case TYPE_POINTER:
                if (word[2] == WORKGROUP) bytes[word[1]] = bytes.at(word[3]);
                break;
            case CONSTANT:
            case SPEC_CONSTANT: values[word[2]] = word[3]; break;
            case VARIABLE:
                if (word[3] == WORKGROUP) sum += bytes.at(word[1]);
                break;
            default: break;
        }
    }
    return sum;
}

DeviceHas enough()
{
    constexpr VkFormatFeatureFlags STORED =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_TRANSFER_SRC_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT;
    DeviceHas has{.max_buffer_bytes = MIN_BUFFER_BYTES, .r8_uint = STORED, .r32_uint = STORED};
    has.limits.maxPerStageDescriptorStorageImages = MAX_STORAGE_IMAGES;
    has.limits.maxPerStageDescriptorStorageBuffers = MAX_STORAGE_BUFFERS;
    has.limits.maxPerStageDescriptorSampledImages = MAX_SAMPLED_IMAGES;
    has.limits.maxPerStageResources = 128;
    has.limits.maxPushConstantsSize = MAX_PUSH_BYTES;
    has.limits.maxComputeWorkGroupInvocations = MAX_GROUP_THREADS;
    has.limits.maxComputeSharedMemorySize = MAX_SHARED_BYTES;
    has.limits.maxStorageBufferRange = MIN_BUFFER_BYTES;
    return has;
}

}  // namespace

TEST_CASE("a device is asked for what the kernel that needs most of it needs")
{
    uint32_t images = 0, buffers = 0, sampled = 0, threads = 0, push = 0, shared = 0;
    for (const EmbeddedKernel& kernel : embedded_kernels()) {
        const KernelInterface found = reflect(kernel.name, {kernel.words, kernel.word_count});
        const auto count = [&](VkDescriptorType type) {
            return uint32_t(std::ranges::count(found.slots, type, &KernelInterface::Slot::type));
        };
        images = std::max(images, count(VK_DESCRIPTOR_TYPE_STORAGE_IMAGE));
        buffers = std::max(buffers, count(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER));
        sampled = std::max(sampled, count(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER));
        push = std::max(push, found.push_bytes);
        shared = std::max(shared, shared_bytes({kernel.words, kernel.word_count}));
        threads = std::max(threads, found.local_size[0] * found.local_size[1] * found.local_size[2]);
    }
    CHECK(images == MAX_STORAGE_IMAGES);
    CHECK(buffers == MAX_STORAGE_BUFFERS);
    CHECK(sampled == MAX_SAMPLED_IMAGES);
    CHECK(push <= MAX_PUSH_BYTES);
    CHECK(shared == MAX_SHARED_BYTES);
    CHECK(threads <= MAX_GROUP_THREADS);
}

TEST_CASE("a device that has less is refused by what it lacks")
{
    CHECK(!why_too_limited(enough()));
    DeviceHas has = enough();
    has.limits.maxPerStageDescriptorStorageImages = 4;  // the least that Vulkan allows
    CHECK(why_too_limited(has) ==
          sentence("it allows 4 storage images in a kernel; expected at least ", MAX_STORAGE_IMAGES));
    has = enough();
    has.limits.maxStorageBufferRange = 1 << 20;
    CHECK(why_too_limited(has) == "it allows 1048576 bytes in a storage buffer; expected at least 67108864");
    has = enough();
    has.max_buffer_bytes = 1 << 20;
    CHECK(why_too_limited(has) == "it allows 1048576 bytes in a buffer; expected at least 67108864");
    has = enough();
    has.limits.maxComputeSharedMemorySize = 4096;
    CHECK(why_too_limited(has) == "it allows 4096 bytes that a group shares; expected at least 10592");
    has = enough();
    has.r8_uint = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    CHECK(why_too_limited(has) ==
          "R8_UINT storage images cannot be read and written; expected a driver that can do so");
    has = enough();
    has.r32_uint = 0;
    CHECK(why_too_limited(has) ==
          "R32_UINT storage images cannot be read and written; expected a driver that can do so");
}

// Kind (Drivers): an unfit device that ranks above a fit one, no driver, and names in other letters
TEST_CASE("of several devices the best is taken that can show the window, and what is named if it can do all")
{
    constexpr auto DISCRETE = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, INTEGRATED = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
                   SOFTWARE = VK_PHYSICAL_DEVICE_TYPE_CPU;
    const std::vector<DeviceRow> rows{{.name = "lavapipe", .type = SOFTWARE},
                                      {.name = "Slim 5", .type = INTEGRATED},
                                      {.name = "Large 9", .type = DISCRETE, .presents = false},
                                      {.name = "Old 1", .type = DISCRETE, .has_1_3 = false},
                                      {.name = "Video 2", .type = DISCRETE, .computes = false}};
    CHECK(best_device(rows, "") == 1);  // the display hangs on the integrated one
    CHECK(best_device(rows, "lava") == 0);
    CHECK(best_device(rows, "LavaPipe") == 0);
    CHECK(best_device(rows, "0") == 0);
    std::vector<DeviceRow> without_window = rows;
    without_window[2].presents = true;
    CHECK(best_device(without_window, "") == 2);
    CHECK_THROWS_WITH(best_device(rows, "Large"),
                      "device Large 9 cannot show pictures in a window on this display; "
                      "--device chooses another; found 0: lavapipe, 1: Slim 5, 2: Large 9, "
                      "3: Old 1 (it does not support Vulkan 1.3), 4: Video 2 (it does not compute)");
    CHECK_THROWS_WITH(best_device(rows, "Old"),
                      "device Old 1, as --device 'Old' says, cannot be used: it does not support Vulkan 1.3; found "
                      "0: lavapipe, 1: Slim 5, 2: Large 9, 3: Old 1 (it does not support Vulkan 1.3), "
                      "4: Video 2 (it does not compute)");
    CHECK_THROWS_AS(best_device(rows, "Video"), Error);
    CHECK_THROWS_WITH(best_device({{.name = "A 1"}}, "llvmpipe", "SHVR_DEVICE"),
                      "SHVR_DEVICE is 'llvmpipe', which no device matches; found 0: A 1");
    CHECK_THROWS_AS(best_device(rows, "7"), Error);
    CHECK_THROWS_WITH(best_device({}, ""),
                      "no Vulkan device found; expected a GPU driver, or the package mesa-vulkan-drivers (lavapipe)");
    // One that lacks something hides no other, however well it ranks.
    std::vector<DeviceRow> partly{{.name = "lavapipe", .type = SOFTWARE},
                                  {.name = "Mock", .type = DISCRETE, .lacks = "a feature is missing"}};
    CHECK(best_device(partly, "") == 0);
    CHECK_THROWS_WITH(best_device(partly, "mock"),
                      "device Mock, as --device 'mock' says, cannot be used: a feature is missing; found 0: lavapipe, "
                      "1: Mock (a feature is missing)");
    partly.erase(partly.begin());
    CHECK_THROWS_WITH(best_device(partly, ""),
                      "no device can be used; expected one with Vulkan 1.3 that runs all kernels; found 0: Mock (a "
                      "feature is missing)");
}

TEST_CASE("densities are in a buffer where Mesa's llvmpipe calls a function for each load of an image")
{
    const auto in_buffer = [](const char* info, VkDriverId driver = VK_DRIVER_ID_MESA_LLVMPIPE) {
        return keeps_atlas_in_buffer(nullptr, driver, info);
    };
    CHECK(in_buffer("Mesa 25.0.7-2+deb13u1 (LLVM 19.1.7)"));
    CHECK(in_buffer("Mesa 23.3.0 (LLVM 17.0.6)"));
    CHECK(!in_buffer("Mesa 23.2.1-1 (LLVM 15.0.7)"));
    CHECK(!in_buffer("Mesa 22.3.6 (LLVM 15.0.6)"));
    CHECK(!in_buffer("Mesa 25.0.7", VK_DRIVER_ID_MESA_RADV));
    CHECK(!in_buffer("unknown"));
    // The environment decides for any driver.
    CHECK(keeps_atlas_in_buffer("buffer", VK_DRIVER_ID_NVIDIA_PROPRIETARY, "570.1"));
    CHECK(!keeps_atlas_in_buffer("image", VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa 25.0.7"));
    CHECK(keeps_atlas_in_buffer("", VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa 25.0.7"));
    CHECK_THROWS_WITH(keeps_atlas_in_buffer("texture", VK_DRIVER_ID_MESA_LLVMPIPE, "Mesa 25.0.7"),
                      "SHVR_ATLAS is 'texture'; expected image or buffer");
}
