#pragma once
// The machine's Vulkan devices, and whether each can run the kernels. Used to choose one and for reports. Any thread.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "engine/gpu/device_needs.h"

namespace shvr::gpu {

/// The Khronos layer, which checks every call.
inline constexpr const char* VALIDATION_LAYER = "VK_LAYER_KHRONOS_validation";

struct FoundDevice {
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    DeviceRow row;
    std::optional<uint32_t> family;  ///< queue family for compute and, if possible, presentation and drawing, or null
};
/// `can_present`: whether a queue family can present to the window; null: presentation is not required.
std::vector<FoundDevice> find_devices(VkInstance instance,
                                      const std::function<bool(VkInstance, VkPhysicalDevice, uint32_t)>& can_present);

bool has_extension(VkPhysicalDevice physical, const char* name);

/// A device in words and numbers.
struct DeviceReport {
    DeviceRow row;
    std::string kind, driver;
    std::string vulkan;       ///< the Vulkan version that the device supports, such as "1.3.230"
    std::string why_unfit;    ///< why the device cannot be used; empty if it can
    uint64_t bytes = 0;       ///< size of the device's largest heap of device-local memory
    uint32_t threads = 0;     ///< number of threads of a software device; 0 for hardware
    std::vector<Need> needs;  ///< limits that the kernels depend on; empty if Vulkan is below 1.3
    struct Option {
        std::string name, gives;
        bool is_present = false;
    };
    std::vector<Option> options;  ///< optional features, and how SHVR uses them
};
/// Lists all devices without creating any. Fails if there is no driver, or if the loader cannot list devices.
std::vector<DeviceReport> survey_devices();
/// Returns the index of the device used by default (without --device). Fails with the reason if there is none.
size_t default_device(const std::vector<DeviceReport>& devices);
/// Whether the Khronos validation layer is installed.
bool validation_is_installed();

}  // namespace shvr::gpu
