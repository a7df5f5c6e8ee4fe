#include "engine/gpu/device.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>
#include <utility>

#include "engine/base/machine/machine.h"
#include "engine/gpu/device_survey.h"

namespace shvr::gpu {

namespace {

const char* name_of(VkResult result)
{
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory";
        case VK_ERROR_MEMORY_MAP_FAILED: return "memory cannot be mapped";
        case VK_ERROR_TOO_MANY_OBJECTS: return "too many objects";
        case VK_ERROR_INITIALIZATION_FAILED: return "initialization failed";
        case VK_ERROR_DEVICE_LOST: return "device lost";
        case VK_ERROR_SURFACE_LOST_KHR: return "surface lost";
        case VK_ERROR_OUT_OF_DATE_KHR: return "out of date";
        case VK_ERROR_LAYER_NOT_PRESENT: return "layer not present";
        case VK_ERROR_EXTENSION_NOT_PRESENT: return "extension not present";
        case VK_ERROR_FEATURE_NOT_PRESENT: return "feature not present";
        case VK_ERROR_INCOMPATIBLE_DRIVER: return "no usable Vulkan driver";
        default: return "error";
    }
}

bool instance_extension_is_present(const char* name, const char* layer)
{
    const auto extensions = enumerate<VkExtensionProperties>([&](uint32_t* count, VkExtensionProperties* items) {
        return vkEnumerateInstanceExtensionProperties(layer, count, items);
    });
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

/// Throws DeviceLost. `fault`: the driver's report; may be empty.
[[noreturn]] void fail_as_lost(const char* call, const std::string& fault)
{
    throw DeviceLost(sentence("the graphics device stopped answering (device lost at ", call,
                              fault.empty() ? "" : "; its driver says: ", fault,
                              "): its driver was reset or it was taken away; start again, or choose another device "
                              "with --device"));
}

const char* name_of(VkDeviceFaultAddressTypeEXT type)
{
    switch (type) {
        case VK_DEVICE_FAULT_ADDRESS_TYPE_READ_INVALID_EXT: return "read at address ";
        case VK_DEVICE_FAULT_ADDRESS_TYPE_WRITE_INVALID_EXT: return "write at address ";
        case VK_DEVICE_FAULT_ADDRESS_TYPE_EXECUTE_INVALID_EXT: return "jump to address ";
        case VK_DEVICE_FAULT_ADDRESS_TYPE_INSTRUCTION_POINTER_UNKNOWN_EXT:
        case VK_DEVICE_FAULT_ADDRESS_TYPE_INSTRUCTION_POINTER_INVALID_EXT:
        case VK_DEVICE_FAULT_ADDRESS_TYPE_INSTRUCTION_POINTER_FAULT_EXT: return "kernel stopped at address ";
        default: return "address ";
    }
}

}  // namespace

void check(VkResult result, const char* call)
{
    if (result >= 0) return;
    if (result == VK_ERROR_DEVICE_LOST) fail_as_lost(call, {});
    const std::string said = sentence("Vulkan: ", call, " returned ", int(result), " (", name_of(result), ")");
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        case VK_ERROR_MEMORY_MAP_FAILED:
        case VK_ERROR_TOO_MANY_OBJECTS: throw MemoryError(said);
        default: throw Error(said);
    }
}

void Device::check(VkResult result, const char* call) const
{
    if (result == VK_ERROR_DEVICE_LOST) fail_as_lost(call, fault_in_words());
    gpu::check(result, call);
}

/// Returns the driver's fault report, with at most the first MOST addresses and codes; empty if there is none.
std::string Device::fault_in_words() const
{
    constexpr uint32_t MOST = 4;
    if (!get_fault_) return {};
    VkDeviceFaultCountsEXT counts{.sType = VK_STRUCTURE_TYPE_DEVICE_FAULT_COUNTS_EXT};
    if (get_fault_(device_, &counts, nullptr) < 0) return {};
    std::vector<VkDeviceFaultAddressInfoEXT> addresses(counts.addressInfoCount);
    std::vector<VkDeviceFaultVendorInfoEXT> codes(counts.vendorInfoCount);
    counts.vendorBinarySize = 0;  // leaves out the vendor binary, a dump for the driver's developers
    VkDeviceFaultInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEVICE_FAULT_INFO_EXT,
                              .pAddressInfos = addresses.data(),
                              .pVendorInfos = codes.data()};
    if (get_fault_(device_, &counts, &info) < 0) return {};
    std::ostringstream words;
    words << info.description;
    for (uint32_t i = 0; i < std::min(counts.addressInfoCount, MOST); ++i)
        words << ", " << name_of(addresses[i].addressType) << "0x" << std::hex << addresses[i].reportedAddress;
    for (uint32_t i = 0; i < std::min(counts.vendorInfoCount, MOST); ++i)
        words << ", " << codes[i].description << " (code " << std::dec << codes[i].vendorFaultCode << ")";
    return words.str();
}

Device::Device(const DeviceOptions& options)
{
    try {
        create_instance(options);
        choose_physical(options);
        create_device(options);
        looks_ahead_ = options.looks_ahead && !traits_.is_cpu;
    } catch (...) {
        destroy();
        throw;
    }
}

Device::~Device()
{
    destroy();
}

void Device::destroy() noexcept
{
    if (device_) {
        vkDeviceWaitIdle(device_);
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) {
        const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy_messenger(instance_, messenger_, nullptr);
    }
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Device::create_instance(const DeviceOptions& options)
{
    const bool validation = options.validation;
    const VkApplicationInfo application{
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "shvr", .apiVersion = VK_API_VERSION_1_3};
    std::vector<const char*> layers;
    std::vector<const char*> extensions;
    for (const std::string& name : options.instance_extensions) {
        if (!instance_extension_is_present(name.c_str(), nullptr))
            fail("Vulkan instance extension ", name, " is missing; expected a driver that can show a window");
        extensions.push_back(name.c_str());
    }
    if (validation) {
        if (!validation_is_installed())
            fail("Vulkan layer ", VALIDATION_LAYER,
                 " is not installed; expected it from the package vulkan-validationlayers");
        layers.push_back(VALIDATION_LAYER);
    }
    const bool debug_utils =
        instance_extension_is_present(VK_EXT_DEBUG_UTILS_EXTENSION_NAME, nullptr) ||
        (validation && instance_extension_is_present(VK_EXT_DEBUG_UTILS_EXTENSION_NAME, layers[0]));
    if (debug_utils) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        // Performance advice is off: it objects to the layout GENERAL, the only one used here (no transitions needed).
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = this};
    const VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                           .pNext = &messenger,
                                           .enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = &synchronisation};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = validation ? &features : nullptr,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = uint32_t(layers.size()),
                                    .ppEnabledLayerNames = layers.data(),
                                    .enabledExtensionCount = uint32_t(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    const VkResult made = vkCreateInstance(&info, nullptr, &instance_);
    if (made == VK_ERROR_INCOMPATIBLE_DRIVER) fail(no_driver_in_words());
    check(made, "vkCreateInstance");
    if (!debug_utils) return;
    const auto load = [&](const char* name) { return vkGetInstanceProcAddr(instance_, name); };
    set_name_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(load("vkSetDebugUtilsObjectNameEXT"));
    begin_label_ = reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(load("vkCmdBeginDebugUtilsLabelEXT"));
    end_label_ = reinterpret_cast<PFN_vkCmdEndDebugUtilsLabelEXT>(load("vkCmdEndDebugUtilsLabelEXT"));
    if (!validation) return;
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(load("vkCreateDebugUtilsMessengerEXT"));
    SHVR_VK(create(instance_, &messenger, nullptr, &messenger_));
}

void Device::choose_physical(const DeviceOptions& options)
{
    const std::vector<FoundDevice> found = find_devices(instance_, options.can_present);
    std::vector<DeviceRow> rows;
    for (const FoundDevice& device : found) rows.push_back(device.row);
    const char* const named = std::getenv("SHVR_DEVICE");
    const size_t best = options.device.empty() ? best_device(rows, named ? named : "", "SHVR_DEVICE")
                                               : best_device(rows, options.device);
    physical_ = found[best].physical;
    queue_family_ = *found[best].family;
    read_traits();
}

void Device::read_traits()
{
    VkPhysicalDeviceMaintenance4Properties buffers{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
    VkPhysicalDeviceMaintenance3Properties maintenance{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES, .pNext = &buffers};
    VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
                                            .pNext = &maintenance};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
    vkGetPhysicalDeviceProperties2(physical_, &properties);
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_properties_);

    traits_.name = properties.properties.deviceName;
    traits_.driver = sentence(driver.driverName, " ", driver.driverInfo);
    traits_.reads_by_address = keeps_atlas_in_buffer(std::getenv("SHVR_ATLAS"), driver.driverID, driver.driverInfo);
    traits_.is_cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    if (traits_.is_cpu) traits_.cpu_threads = uint32_t(processors_allowed());
    traits_.limits = properties.properties.limits;
    traits_.is_integrated = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    traits_.max_allocation_bytes = maintenance.maxMemoryAllocationSize;
    traits_.max_buffer_bytes = buffers.maxBufferSize;
    traits_.tells_faults = has_extension(physical_, VK_EXT_DEVICE_FAULT_EXTENSION_NAME);
    traits_.tells_memory_left = has_extension(physical_, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    traits_.has_memory_priority = has_extension(physical_, VK_EXT_MEMORY_PRIORITY_EXTENSION_NAME);
    const auto families = enumerate<VkQueueFamilyProperties>([&](uint32_t* count, VkQueueFamilyProperties* items) {
        vkGetPhysicalDeviceQueueFamilyProperties(physical_, count, items);
    });
    traits_.timestamp_bits = families[queue_family_].timestampValidBits;
    traits_.nanoseconds_per_tick = traits_.timestamp_bits ? traits_.limits.timestampPeriod : 0.0f;
    VkFormatProperties r16;
    vkGetPhysicalDeviceFormatProperties(physical_, VK_FORMAT_R16_UNORM, &r16);
    traits_.linear_r16 = r16.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    traits_.storage_r16 = r16.optimalTilingFeatures & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
    traits_.max_volume_bytes = traits_.max_allocation_bytes;
    for (const VkFormat codes : {VK_FORMAT_R16_UNORM, VK_FORMAT_R32_UINT}) {
        VkImageFormatProperties image;
        if (vkGetPhysicalDeviceImageFormatProperties(
                physical_, codes, VK_IMAGE_TYPE_3D, VK_IMAGE_TILING_OPTIMAL,
                VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, 0,
                &image) == VK_SUCCESS)
            traits_.max_volume_bytes = std::min(traits_.max_volume_bytes, uint64_t(image.maxResourceSize));
    }
    for (uint32_t i = 0; i < memory_properties_.memoryHeapCount; ++i) {
        const VkMemoryHeap& heap = memory_properties_.memoryHeaps[i];
        if (!(heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) && !traits_.is_integrated) continue;
        if (heap.size <= traits_.device_bytes) continue;
        traits_.device_bytes = heap.size;
        heap_ = i;
    }
}

std::optional<uint64_t> Device::heap_bytes_left() const
{
    if (!traits_.tells_memory_left) return std::nullopt;
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
    VkPhysicalDeviceMemoryProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2,
                                                 .pNext = &budget};
    vkGetPhysicalDeviceMemoryProperties2(physical_, &properties);
    return budget.heapBudget[heap_] - std::min(budget.heapBudget[heap_], budget.heapUsage[heap_]);
}

void Device::create_device(const DeviceOptions& options)
{
    VkPhysicalDeviceVulkan13Features has13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features has12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                           .pNext = &has13};
    VkPhysicalDeviceFeatures2 has{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &has12};
    vkGetPhysicalDeviceFeatures2(physical_, &has);

    // Every device supports robust images and buffers. Robust images: word_at(-1) of density_exact.glsl at the atlas's
    // edge, whose result is unused, reads 0 and is not undefined. Robust buffers: no kernel reads or writes out of
    // bounds (bounds_slow_test.cpp), but such a bug would give a wrong pixel, not a lost device or corrupted paint.
    VkPhysicalDeviceVulkan13Features want13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                            .robustImageAccess = VK_TRUE,
                                            .synchronization2 = VK_TRUE,
                                            .maintenance4 = VK_TRUE};
    VkPhysicalDeviceVulkan12Features want12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                            .pNext = &want13,
                                            .scalarBlockLayout = VK_TRUE,
                                            .hostQueryReset = VK_TRUE,
                                            .timelineSemaphore = VK_TRUE,
                                            .bufferDeviceAddress = VK_TRUE};
    VkPhysicalDeviceFeatures2 want{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &want12};
    want.features.robustBufferAccess = options.robust_buffers ? VK_TRUE : VK_FALSE;
    want.features.shaderStorageImageExtendedFormats = VK_TRUE;
    traits_.has_pipeline_statistics = has.features.pipelineStatisticsQuery == VK_TRUE;
    want.features.pipelineStatisticsQuery = has.features.pipelineStatisticsQuery;

    VkPhysicalDeviceFaultFeaturesEXT faults{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FAULT_FEATURES_EXT,
                                            .deviceFault = VK_TRUE};
    if (traits_.tells_faults) want13.pNext = &faults;
    VkPhysicalDeviceMemoryPriorityFeaturesEXT priorities{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PRIORITY_FEATURES_EXT,
        .pNext = want13.pNext,
        .memoryPriority = VK_TRUE};
    if (traits_.has_memory_priority) want13.pNext = &priorities;

    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = queue_family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    std::vector<const char*> extensions;
    if (!options.instance_extensions.empty()) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    if (traits_.tells_memory_left) extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    if (traits_.tells_faults) extensions.push_back(VK_EXT_DEVICE_FAULT_EXTENSION_NAME);
    if (traits_.has_memory_priority) extensions.push_back(VK_EXT_MEMORY_PRIORITY_EXTENSION_NAME);
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &want,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = uint32_t(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data()};
    SHVR_VK(vkCreateDevice(physical_, &info, nullptr, &device_));
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
    if (traits_.tells_faults)
        get_fault_ =
            reinterpret_cast<PFN_vkGetDeviceFaultInfoEXT>(vkGetDeviceProcAddr(device_, "vkGetDeviceFaultInfoEXT"));
    set_name(VK_OBJECT_TYPE_QUEUE, reinterpret_cast<uint64_t>(queue_), "queue");
}

void Device::set_name(VkObjectType type, uint64_t handle, const std::string& name) const
{
    if (!set_name_) return;
    const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                             .objectType = type,
                                             .objectHandle = handle,
                                             .pObjectName = name.c_str()};
    set_name_(device_, &info);
}

void Device::begin_label(VkCommandBuffer commands, const std::string& name) const
{
    if (!begin_label_) return;
    const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = name.c_str()};
    begin_label_(commands, &label);
}

void Device::end_label(VkCommandBuffer commands) const
{
    if (end_label_) end_label_(commands);
}

void Device::wait_idle()
{
    check(vkDeviceWaitIdle(device_), "vkDeviceWaitIdle");
    done_ = submitted_;
}

void Device::wait_idle_or_lost() noexcept
{
    static_cast<void>(vkDeviceWaitIdle(device_));
    done_ = submitted_;
}

std::vector<std::string> Device::take_validation_messages()
{
    const std::lock_guard lock(messages_mutex_);
    return std::exchange(messages_, {});
}

VkBool32 Device::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* self)
{
    // The Vulkan loader sends messages here as well; they concern layers added by the environment.
    if (data->pMessageIdName && std::strcmp(data->pMessageIdName, "Loader Message") == 0) return VK_FALSE;
    Device& device = *static_cast<Device*>(self);
    const std::lock_guard lock(device.messages_mutex_);
    device.messages_.emplace_back(data->pMessage ? data->pMessage : "(no text)");
    return VK_FALSE;
}

}  // namespace shvr::gpu
