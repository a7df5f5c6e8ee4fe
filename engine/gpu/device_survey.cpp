#include "engine/gpu/device_survey.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "engine/base/machine/machine.h"
#include "engine/gpu/device.h"

namespace shvr::gpu {

namespace {

/// A queue family that supports compute, and its other capabilities.
struct Family {
    uint32_t index = 0;
    bool presents = false;
};
std::optional<Family> compute_family(VkInstance instance, VkPhysicalDevice physical,
                                     const std::function<bool(VkInstance, VkPhysicalDevice, uint32_t)>& can_present)
{
    const auto families = enumerate<VkQueueFamilyProperties>([&](uint32_t* count, VkQueueFamilyProperties* items) {
        vkGetPhysicalDeviceQueueFamilyProperties(physical, count, items);
    });
    const auto worth = [&](uint32_t i) {
        const bool presents = !can_present || can_present(instance, physical, i);
        return std::pair(presents, (families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0);
    };
    std::optional<Family> best;
    for (uint32_t i = 0; i < families.size(); ++i) {
        if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
        if (!best || worth(i) > worth(best->index)) best = Family{i, worth(i).first};
    }
    return best;
}

VkFormatFeatureFlags features_of(VkPhysicalDevice physical, VkFormat format)
{
    VkFormatProperties found;
    vkGetPhysicalDeviceFormatProperties(physical, format, &found);
    return found.optimalTilingFeatures;
}

DeviceHas capabilities_of(VkPhysicalDevice physical)
{
    VkPhysicalDeviceMaintenance4Properties buffers{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &buffers};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    return {.limits = properties.properties.limits,
            .max_buffer_bytes = buffers.maxBufferSize,
            .r8_uint = features_of(physical, VK_FORMAT_R8_UINT),
            .r32_uint = features_of(physical, VK_FORMAT_R32_UINT)};
}

/// Returns why a device with Vulkan 1.3 cannot run the kernels; empty if it can.
std::string why_it_cannot(VkPhysicalDevice physical)
{
    VkPhysicalDeviceVulkan12Features has12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 has{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &has12};
    vkGetPhysicalDeviceFeatures2(physical, &has);
    // The shared headers need scalar layout: optional in 1.3, but supported by all desktop drivers and lavapipe.
    if (!has12.scalarBlockLayout)
        return "the Vulkan feature scalarBlockLayout is missing; expected a driver that has it";
    if (!has12.bufferDeviceAddress)
        return "the Vulkan feature bufferDeviceAddress is missing; expected a driver that has it";
    const bool stores_r16 = features_of(physical, VK_FORMAT_R16_UNORM) & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
    if (!stores_r16 || !has.features.shaderStorageImageExtendedFormats)
        return "R16_UNORM storage images cannot be read; expected a driver that can read them";
    return why_too_limited(capabilities_of(physical)).value_or("");
}

const char* in_words(VkPhysicalDeviceType type)
{
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU: return "software on the processor";
        default: return "other device";
    }
}

uint64_t local_bytes(VkPhysicalDevice physical)
{
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical, &memory);
    uint64_t most = 0;
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            most = std::max(most, uint64_t(memory.memoryHeaps[i].size));
    return most;
}

std::vector<DeviceReport::Option> options_of(VkPhysicalDevice physical)
{
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(physical, &features);
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    const bool filters_r16 =
        features_of(physical, VK_FORMAT_R16_UNORM) & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    return {{"filtering of 16-bit images", "faster sampling (render.sampling filtered)", filters_r16},
            {"timestamps", "times of passes", properties.limits.timestampComputeAndGraphics == VK_TRUE},
            {"pipeline statistics", "counts of kernel invocations", features.pipelineStatisticsQuery == VK_TRUE},
            {VK_EXT_MEMORY_BUDGET_EXTENSION_NAME, "a budget that leaves other programs their memory",
             has_extension(physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME)},
            {VK_EXT_MEMORY_PRIORITY_EXTENSION_NAME, "pictures kept on the device before bricks",
             has_extension(physical, VK_EXT_MEMORY_PRIORITY_EXTENSION_NAME)},
            {VK_EXT_DEVICE_FAULT_EXTENSION_NAME, "the driver's report after a lost device",
             has_extension(physical, VK_EXT_DEVICE_FAULT_EXTENSION_NAME)}};
}

DeviceReport report_on(const FoundDevice& device)
{
    VkPhysicalDeviceProperties basic;
    vkGetPhysicalDeviceProperties(device.physical, &basic);
    const uint32_t version = basic.apiVersion;
    VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
    if (version >= VK_API_VERSION_1_2) vkGetPhysicalDeviceProperties2(device.physical, &properties);
    return {.row = device.row,
            .kind = in_words(device.row.type),
            .driver = version >= VK_API_VERSION_1_2 ? sentence(driver.driverName, " ", driver.driverInfo) : "",
            .vulkan = sentence(VK_API_VERSION_MAJOR(version), '.', VK_API_VERSION_MINOR(version), '.',
                               VK_API_VERSION_PATCH(version)),
            .why_unfit = why_unfit(device.row),
            .bytes = local_bytes(device.physical),
            .threads = device.row.type == VK_PHYSICAL_DEVICE_TYPE_CPU ? unsigned(processors_allowed()) : 0,
            .needs = device.row.has_1_3 ? needs_of(capabilities_of(device.physical)) : std::vector<Need>(),
            .options = options_of(device.physical)};
}

}  // namespace

bool has_extension(VkPhysicalDevice physical, const char* name)
{
    const auto extensions = enumerate<VkExtensionProperties>([&](uint32_t* count, VkExtensionProperties* items) {
        return vkEnumerateDeviceExtensionProperties(physical, nullptr, count, items);
    });
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

std::vector<FoundDevice> find_devices(VkInstance instance,
                                      const std::function<bool(VkInstance, VkPhysicalDevice, uint32_t)>& can_present)
{
    std::vector<FoundDevice> found;
    for (const VkPhysicalDevice physical : enumerate<VkPhysicalDevice>([&](uint32_t*count, VkPhysicalDevice*items) {
             return vkEnumeratePhysicalDevices(instance, count, items);
         })) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(physical, &properties);
        const std::optional<Family> family = compute_family(instance, physical, can_present);
        const bool has_1_3 = properties.apiVersion >= VK_API_VERSION_1_3;
        found.push_back({.physical = physical,
                         .row = {.name = properties.deviceName,
                                 .type = properties.deviceType,
                                 .has_1_3 = has_1_3,
                                 .computes = family.has_value(),
                                 .presents = family && family->presents,
                                 .lacks = has_1_3 ? why_it_cannot(physical) : ""},
                         .family = family ? std::optional(family->index) : std::nullopt});
    }
    return found;
}

std::vector<DeviceReport> survey_devices()
{
    const VkApplicationInfo application{
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "shvr", .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    VkInstance instance = VK_NULL_HANDLE;
    const VkResult made = vkCreateInstance(&info, nullptr, &instance);
    if (made == VK_ERROR_INCOMPATIBLE_DRIVER) fail(no_driver_in_words());
    check(made, "vkCreateInstance");
    const std::unique_ptr<VkInstance_T, void (*)(VkInstance)> owner(
        instance, [](VkInstance owned) { vkDestroyInstance(owned, nullptr); });
    std::vector<DeviceReport> reports;
    for (const FoundDevice& device : find_devices(instance, {})) reports.push_back(report_on(device));
    if (reports.empty()) fail(no_driver_in_words());
    return reports;
}

size_t default_device(const std::vector<DeviceReport>& devices)
{
    std::vector<DeviceRow> rows;
    for (const DeviceReport& device : devices) rows.push_back(device.row);
    const char* const named = std::getenv("SHVR_DEVICE");
    return best_device(rows, named ? named : "", "SHVR_DEVICE");
}

bool validation_is_installed()
{
    const auto layers = enumerate<VkLayerProperties>(
        [](uint32_t* count, VkLayerProperties* items) { return vkEnumerateInstanceLayerProperties(count, items); });
    return std::ranges::any_of(
        layers, [](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, VALIDATION_LAYER) == 0; });
}

}  // namespace shvr::gpu
