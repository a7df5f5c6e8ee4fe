#pragma once
// Device capabilities that the kernels require although Vulkan 1.3 does not guarantee them, so some devices lack them.
// A test compares them with the kernels (tests/unit/device/device_needs_test.cpp). Any thread.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

namespace shvr::gpu {

/// Of each resource type, the largest number that any kernel binds; of each size, the maximum over all kernels.
inline constexpr uint32_t MAX_STORAGE_IMAGES = 13, MAX_STORAGE_BUFFERS = 7, MAX_SAMPLED_IMAGES = 4;
inline constexpr uint32_t MAX_PUSH_BYTES = 128, MAX_GROUP_THREADS = 128, MAX_SHARED_BYTES = 10592;
/// Size of the largest buffer that does not grow with the volume: union-find parents of 256^3 voxels (regions/).
inline constexpr uint32_t MIN_BUFFER_BYTES = 64u << 20;

/// Capabilities that a device reports.
struct DeviceHas {
    VkPhysicalDeviceLimits limits{};
    uint64_t max_buffer_bytes = 0;
    VkFormatFeatureFlags r8_uint = 0, r32_uint = 0;  ///< features of images with optimal tiling
};

/// One of the limits that the kernels depend on.
struct Need {
    const char* what;  ///< "storage images in a kernel"
    uint64_t has, needed;
};
std::vector<Need> needs_of(const DeviceHas& has);

/// Returns why a device with these limits cannot run the kernels, with the value found and the value expected; null if
/// the device can run them.
std::optional<std::string> why_too_limited(const DeviceHas& has);

/// Whether densities that kernels read exactly are kept in a buffer, read by its address, instead of images; the bits
/// are the same. `named`: the value of SHVR_ATLAS, "image" or "buffer"; null or empty: a buffer with llvmpipe of Mesa
/// 23.3 and later, where each load of an image is a call (shaders/MEASURED.md, "Mesa 25"). `info`: as a driver of Mesa
/// states its version, such as "Mesa 25.0.7 (LLVM 19.1.7)".
bool keeps_atlas_in_buffer(const char* named, VkDriverId driver, const std::string& info);

/// Returns the message for a system without any Vulkan driver. It names a limit of the process's memory, which can keep
/// a driver from loading; the loader reports no reason.
std::string no_driver_in_words();

/// One of the machine's devices.
struct DeviceRow {
    std::string name;
    VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
    bool has_1_3 = true;
    bool computes = true;
    bool presents = true;  ///< whether the device can present to the window, if there is one
    std::string lacks{};   ///< why the device cannot run the kernels; empty if it can, or if unknown
};
/// Returns why a device cannot be used (presentation aside); empty if it can be used.
std::string why_unfit(const DeviceRow& row);
/// Returns the index of the device to use: among those that meet all requirements, hardware before software, discrete
/// before integrated. `wanted`: part of a name, in upper or lower case, or an index; empty: any device. `wanted_by`:
/// the option or variable that sets `wanted`. The error lists the devices and why each is unfit.
size_t best_device(const std::vector<DeviceRow>& rows, const std::string& wanted,
                   const std::string& wanted_by = "--device");

}  // namespace shvr::gpu
