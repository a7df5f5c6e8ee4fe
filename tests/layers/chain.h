#pragma once
// Turns a set of hooks into a Vulkan layer (vk_layer.h, interface version 2). A layer is a struct with
//
//   static PFN_vkVoidFunction hook(const char* name);     // null: not hooked
//   static void instance_made(VkInstance);                // these three have defaults in `Unobtrusive`:
//   static void instance_goes(VkInstance);
//   static VkDeviceCreateInfo device_info(const VkDeviceCreateInfo&);   // as the driver gets it
//
// and its manifest names `Chain<Layer>::negotiate`. `Chain<Layer>::next` calls the next layer or the driver. Any
// thread.

#include <algorithm>
#include <cstring>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

namespace layers {

/// The same for a device, its queues and its command buffers.
template <class Handle>
void* table_of(Handle handle)
{
    return *reinterpret_cast<void**>(handle);
}

/// The loader's record of the next layer, which each layer advances.
template <class Record>
Record* link_in(const void* chain, VkStructureType type)
{
    for (const auto* at = static_cast<const VkBaseInStructure*>(chain); at; at = at->pNext) {
        auto* const record = reinterpret_cast<Record*>(const_cast<VkBaseInStructure*>(at));
        if (at->sType == type && record->function == VK_LAYER_LINK_INFO) return record;
    }
    return nullptr;
}

/// The structure of that type behind a query, or null.
template <class Structure>
Structure* chained(void* query, VkStructureType type)
{
    for (auto* at = static_cast<VkBaseOutStructure*>(query); at; at = at->pNext)
        if (at->sType == type) return reinterpret_cast<Structure*>(at);
    return nullptr;
}

/// Answers an enumeration call, which is made twice: first for the count, then for the items.
template <class Item>
VkResult answer(const std::vector<Item>& all, uint32_t* count, Item* found)
{
    const auto there = uint32_t(all.size()), copied = found ? std::min(*count, there) : there;
    if (found) std::copy_n(all.begin(), copied, found);
    *count = copied;
    return copied < there ? VK_INCOMPLETE : VK_SUCCESS;
}

/// What layers may ask for.
inline constexpr const char* INSTANCE_CALLS[] = {"vkDestroyInstance",
                                                 "vkGetPhysicalDeviceProperties",
                                                 "vkGetPhysicalDeviceProperties2",
                                                 "vkGetPhysicalDeviceFormatProperties",
                                                 "vkGetPhysicalDeviceImageFormatProperties",
                                                 "vkGetPhysicalDeviceQueueFamilyProperties",
                                                 "vkGetPhysicalDeviceSurfacePresentModesKHR",
                                                 "vkEnumerateDeviceExtensionProperties"};

/// Calls of extensions that a layer may add to a driver which has none of them.
inline constexpr const char* ADDED_CALLS[] = {"vkGetDeviceFaultInfoEXT"};
inline bool is_added(const char* name)
{
    return std::ranges::any_of(ADDED_CALLS, [&](const char* one) { return std::strcmp(name, one) == 0; });
}

/// Defaults for a layer that only hooks calls: the base of layers that hide none of these.
struct Unobtrusive {
    static void instance_made(VkInstance) {}
    static void instance_goes(VkInstance) {}
    static VkDeviceCreateInfo device_info(const VkDeviceCreateInfo& info) { return info; }
};

template <class Layer>
class Chain {
public:
    /// The next layer's function, for calls on an instance or a physical device.
    template <class Call, class Handle>
    static Call next_of_instance(Handle, const char* name)
    {
        const std::lock_guard lock(known().mutex);
        return reinterpret_cast<Call>(known().instances.back().calls.at(name));
    }
    /// The next layer's function, for calls on a device, a queue or a command buffer.
    template <class Call, class Handle>
    static Call next(Handle handle, const char* name)
    {
        const std::lock_guard lock(known().mutex);
        const Device& device = known().devices.at(table_of(handle));
        return reinterpret_cast<Call>(device.next(device.handle, name));
    }

    static VkResult negotiate(VkNegotiateLayerInterface* interface)
    {
        interface->loaderLayerInterfaceVersion = 2;
        interface->pfnGetInstanceProcAddr = get_instance_call;
        interface->pfnGetDeviceProcAddr = get_device_call;
        interface->pfnGetPhysicalDeviceProcAddr = nullptr;
        return VK_SUCCESS;
    }

private:
    struct Instance {
        PFN_vkGetInstanceProcAddr next = nullptr;
        VkInstance handle = VK_NULL_HANDLE;
        std::unordered_map<std::string, PFN_vkVoidFunction> calls;
    };
    struct Device {
        PFN_vkGetDeviceProcAddr next = nullptr;
        VkDevice handle = VK_NULL_HANDLE;
    };
    struct Known {
        std::mutex mutex;
        std::vector<Instance> instances;  ///< the last one made is current: tests make one after another
        std::unordered_map<void*, Device> devices;
    };
    static Known& known()
    {
        static Known* const one = new Known;  // calls may come while the program ends
        return *one;
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                                          const VkAllocationCallbacks* allocator, VkInstance* instance)
    {
        auto* const link =
            link_in<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
        if (!link) return VK_ERROR_INITIALIZATION_FAILED;
        const PFN_vkGetInstanceProcAddr next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
        link->u.pLayerInfo = link->u.pLayerInfo->pNext;
        const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
        const VkResult result = create(info, allocator, instance);
        if (result != VK_SUCCESS) return result;
        {
            const std::lock_guard lock(known().mutex);
            Instance& made = known().instances.emplace_back(Instance{next, *instance, {}});
            // Queried now: if asked later, the loader gives the last layer the first one's calls.
            for (const char* name : INSTANCE_CALLS) made.calls[name] = next(*instance, name);
        }
        Layer::instance_made(*instance);
        return result;
    }

    static VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* allocator)
    {
        if (!instance) return;
        Layer::instance_goes(instance);
        const auto destroy = next_of_instance<PFN_vkDestroyInstance>(instance, "vkDestroyInstance");
        {
            const std::lock_guard lock(known().mutex);
            std::erase_if(known().instances, [&](const Instance& one) { return one.handle == instance; });
        }
        destroy(instance, allocator);
    }

    static VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                                        const VkAllocationCallbacks* allocator, VkDevice* device)
    {
        auto* const link = link_in<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
        if (!link) return VK_ERROR_INITIALIZATION_FAILED;
        const PFN_vkGetInstanceProcAddr of_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
        const PFN_vkGetDeviceProcAddr next = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
        link->u.pLayerInfo = link->u.pLayerInfo->pNext;
        VkInstance instance = VK_NULL_HANDLE;
        {
            const std::lock_guard lock(known().mutex);
            instance = known().instances.back().handle;
        }
        const auto create = reinterpret_cast<PFN_vkCreateDevice>(of_instance(instance, "vkCreateDevice"));
        const VkDeviceCreateInfo changed = Layer::device_info(*info);
        const VkResult result = create(physical, &changed, allocator, device);
        if (result != VK_SUCCESS) return result;
        const std::lock_guard lock(known().mutex);
        known().devices[table_of(*device)] = {next, *device};
        return result;
    }

    static VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* allocator)
    {
        if (!device) return;
        const auto destroy = next<PFN_vkDestroyDevice>(device, "vkDestroyDevice");
        {
            const std::lock_guard lock(known().mutex);
            known().devices.erase(table_of(device));
        }
        destroy(device, allocator);
    }

    static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_call(VkDevice device, const char* name)
    {
        if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
            return reinterpret_cast<PFN_vkVoidFunction>(&get_device_call);
        if (std::strcmp(name, "vkDestroyDevice") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&destroy_device);
        PFN_vkGetDeviceProcAddr next = nullptr;
        {
            const std::lock_guard lock(known().mutex);
            const auto found = known().devices.find(table_of(device));
            if (found != known().devices.end()) next = found->second.next;
        }
        const PFN_vkVoidFunction there = next ? next(device, name) : nullptr;
        const PFN_vkVoidFunction hooked = Layer::hook(name);
        return hooked && (there || is_added(name)) ? hooked : there;
    }

    static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_call(VkInstance instance, const char* name)
    {
        const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
        if (is("vkGetInstanceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(&get_instance_call);
        if (is("vkGetDeviceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(&get_device_call);
        if (is("vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(&create_instance);
        if (is("vkDestroyInstance")) return reinterpret_cast<PFN_vkVoidFunction>(&destroy_instance);
        if (is("vkCreateDevice")) return reinterpret_cast<PFN_vkVoidFunction>(&create_device);
        if (is("vkDestroyDevice")) return reinterpret_cast<PFN_vkVoidFunction>(&destroy_device);
        if (!instance) return nullptr;
        PFN_vkGetInstanceProcAddr next = nullptr;
        {
            const std::lock_guard lock(known().mutex);
            for (const Instance& one : known().instances)
                if (one.handle == instance) next = one.next;
        }
        const PFN_vkVoidFunction there = next ? next(instance, name) : nullptr;
        const PFN_vkVoidFunction hooked = Layer::hook(name);
        return hooked && there ? hooked : there;
    }
};

}  // namespace layers
