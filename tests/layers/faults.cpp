// A Vulkan layer for tests: the n-th call of an entry point fails, as a driver may let it.
//
//   SHVR_FAULTS="vkQueueSubmit2:40:device_lost vkQueuePresentKHR:3+:suboptimal"
//
// CALL:N:ERROR lets the N-th call fail, CALL:N+:ERROR every call from the N-th on. A call that fails does not reach the
// driver; one that is `suboptimal` does as it should. Once the device is lost, it stays so: all calls that may say so
// do, until the device is destroyed; a device created afterwards is whole. Faults count from the creation of the
// instance, and each fires once, so that re-created objects are not lost again.
//
// SHVR_FAULTS_NOW names a file: when it appears, the faults that it lists are added, counted from then on, and it is
// removed. It must appear whole, by renaming.
//
// SHVR_FAULTS_LOG names a file for the faults that fired, and at the end how often each entry point was called, and
// "leaked CALL N" for N objects that it made and that were never destroyed.
//
// Sits between the loader and the next layer or driver (vk_layer.h, interface version 2). Any thread.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "chain.h"

namespace {

using layers::link_in;
using layers::table_of;

// Entry points that return a VkResult and that the program or Dear ImGui calls.
#define SHVR_DEVICE_CALLS(X)                                                                                           \
    X(vkAllocateMemory)                                                                                                \
    X(vkMapMemory)                                                                                                     \
    X(vkBindBufferMemory)                                                                                              \
    X(vkBindImageMemory)                                                                                               \
    X(vkCreateBuffer)                                                                                                  \
    X(vkCreateImage)                                                                                                   \
    X(vkCreateImageView)                                                                                               \
    X(vkCreateSampler)                                                                                                 \
    X(vkCreateShaderModule)                                                                                            \
    X(vkCreateDescriptorSetLayout)                                                                                     \
    X(vkCreatePipelineLayout)                                                                                          \
    X(vkCreatePipelineCache)                                                                                           \
    X(vkGetPipelineCacheData)                                                                                          \
    X(vkCreateComputePipelines)                                                                                        \
    X(vkCreateGraphicsPipelines)                                                                                       \
    X(vkCreateRenderPass)                                                                                              \
    X(vkCreateFramebuffer)                                                                                             \
    X(vkCreateDescriptorPool)                                                                                          \
    X(vkAllocateDescriptorSets)                                                                                        \
    X(vkCreateCommandPool)                                                                                             \
    X(vkResetCommandPool)                                                                                              \
    X(vkAllocateCommandBuffers)                                                                                        \
    X(vkBeginCommandBuffer)                                                                                            \
    X(vkEndCommandBuffer)                                                                                              \
    X(vkCreateQueryPool)                                                                                               \
    X(vkGetQueryPoolResults)                                                                                           \
    X(vkCreateFence)                                                                                                   \
    X(vkResetFences)                                                                                                   \
    X(vkGetFenceStatus)                                                                                                \
    X(vkWaitForFences)                                                                                                 \
    X(vkCreateSemaphore)                                                                                               \
    X(vkQueueSubmit)                                                                                                   \
    X(vkQueueSubmit2)                                                                                                  \
    X(vkQueueWaitIdle)                                                                                                 \
    X(vkDeviceWaitIdle)                                                                                                \
    X(vkCreateSwapchainKHR)                                                                                            \
    X(vkGetSwapchainImagesKHR)                                                                                         \
    X(vkAcquireNextImageKHR)                                                                                           \
    X(vkQueuePresentKHR)
#define SHVR_INSTANCE_CALLS(X)                                                                                         \
    X(vkGetPhysicalDeviceSurfaceSupportKHR)                                                                            \
    X(vkGetPhysicalDeviceSurfaceCapabilitiesKHR)                                                                       \
    X(vkGetPhysicalDeviceSurfaceFormatsKHR)

// Calls that destroy objects, with the calls that create them.
#define SHVR_ENDS(X)                                                                                                   \
    X(vkFreeMemory, VkDeviceMemory, vkAllocateMemory)                                                                  \
    X(vkDestroyBuffer, VkBuffer, vkCreateBuffer)                                                                       \
    X(vkDestroyImage, VkImage, vkCreateImage)                                                                          \
    X(vkDestroyImageView, VkImageView, vkCreateImageView)                                                              \
    X(vkDestroySampler, VkSampler, vkCreateSampler)                                                                    \
    X(vkDestroyShaderModule, VkShaderModule, vkCreateShaderModule)                                                     \
    X(vkDestroyDescriptorSetLayout, VkDescriptorSetLayout, vkCreateDescriptorSetLayout)                                \
    X(vkDestroyPipelineLayout, VkPipelineLayout, vkCreatePipelineLayout)                                               \
    X(vkDestroyPipeline, VkPipeline, vkCreateComputePipelines)                                                         \
    X(vkDestroyPipelineCache, VkPipelineCache, vkCreatePipelineCache)                                                  \
    X(vkDestroyDescriptorPool, VkDescriptorPool, vkCreateDescriptorPool)                                               \
    X(vkDestroyCommandPool, VkCommandPool, vkCreateCommandPool)                                                        \
    X(vkDestroyQueryPool, VkQueryPool, vkCreateQueryPool)                                                              \
    X(vkDestroyFence, VkFence, vkCreateFence)                                                                          \
    X(vkDestroySemaphore, VkSemaphore, vkCreateSemaphore)

enum Call : size_t {
#define SHVR_NUMBER(name) CALL_##name,
    SHVR_DEVICE_CALLS(SHVR_NUMBER) SHVR_INSTANCE_CALLS(SHVR_NUMBER)
#undef SHVR_NUMBER
        CALLS
};
constexpr const char* NAMES[] = {
#define SHVR_NAME(name) #name,
    SHVR_DEVICE_CALLS(SHVR_NAME) SHVR_INSTANCE_CALLS(SHVR_NAME)
#undef SHVR_NAME
};
constexpr size_t DEVICE_CALLS = CALL_vkGetPhysicalDeviceSurfaceSupportKHR;

struct Spelling {
    const char* name;
    VkResult result;
};
constexpr Spelling ERRORS[] = {{"out_of_host_memory", VK_ERROR_OUT_OF_HOST_MEMORY},
                               {"out_of_device_memory", VK_ERROR_OUT_OF_DEVICE_MEMORY},
                               {"device_lost", VK_ERROR_DEVICE_LOST},
                               {"surface_lost", VK_ERROR_SURFACE_LOST_KHR},
                               {"out_of_date", VK_ERROR_OUT_OF_DATE_KHR},
                               {"not_ready", VK_NOT_READY},
                               {"suboptimal", VK_SUBOPTIMAL_KHR}};

/// Calls that may return VK_ERROR_DEVICE_LOST. Those that wait let the driver finish first.
constexpr Call TELL_OF_LOSS[] = {CALL_vkQueueSubmit,         CALL_vkQueueSubmit2,       CALL_vkGetFenceStatus,
                                 CALL_vkWaitForFences,       CALL_vkQueueWaitIdle,      CALL_vkDeviceWaitIdle,
                                 CALL_vkGetQueryPoolResults, CALL_vkCreateSwapchainKHR, CALL_vkAcquireNextImageKHR,
                                 CALL_vkQueuePresentKHR};

struct Fault {
    size_t call = CALLS;
    uint64_t number = 0;
    bool goes_on = false;
    Spelling error{};
    bool has_fired = false;
};

/// State of the layer. One for all devices: tests make them one after another.
struct State {
    std::mutex mutex;
    struct Instance {
        PFN_vkGetInstanceProcAddr next = nullptr;
        VkInstance handle = VK_NULL_HANDLE;
        PFN_vkVoidFunction calls[CALLS]{};  ///< from DEVICE_CALLS on
        PFN_vkDestroyInstance destroy = nullptr;
    };
    struct Device {
        PFN_vkGetDeviceProcAddr next = nullptr;
        VkDevice handle = VK_NULL_HANDLE;
        bool is_lost = false;
        PFN_vkVoidFunction calls[DEVICE_CALLS]{};
        PFN_vkVoidFunction ends[DEVICE_CALLS]{};  ///< destroy the object that the call creates
    };
    std::vector<Instance> instances;            ///< the last one made is current: tests make one after another
    std::unordered_map<void*, Device> devices;  ///< likewise, for queues and command buffers
    std::vector<Fault> faults;
    uint64_t counts[CALLS]{};
    int64_t alive[CALLS]{};  ///< made by that call, and not destroyed
};
State& state()
{
    static State* const one = new State;  // calls may come while the program ends
    return *one;
}

void write_log(const std::string& line)
{
    if (const char* const path = std::getenv("SHVR_FAULTS_LOG")) std::ofstream(path, std::ios::app) << line << '\n';
}

/// Aborts on what it cannot read: a test with a misspelt fault would test nothing.
std::vector<Fault> faults_of(const std::string& text)
{
    std::vector<Fault> faults;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        std::istringstream parts(word);
        std::string call, number, error;
        std::getline(std::getline(std::getline(parts, call, ':'), number, ':'), error);
        Fault fault;
        fault.call =
            size_t(std::find_if(std::begin(NAMES), std::end(NAMES), [&](const char* name) { return call == name; }) -
                   std::begin(NAMES));
        fault.goes_on = !number.empty() && number.back() == '+';
        fault.number = std::strtoull(number.c_str(), nullptr, 10);
        const auto* const found = std::find_if(std::begin(ERRORS), std::end(ERRORS),
                                               [&](const Spelling& spelling) { return error == spelling.name; });
        if (fault.call == CALLS || fault.number == 0 || found == std::end(ERRORS)) {
            write_log("'" + word + "' is no fault; expected CALL:N:ERROR or CALL:N+:ERROR");
            std::abort();
        }
        fault.error = *found;
        faults.push_back(fault);
    }
    return faults;
}

void look_for_faults(State& known)
{
    static const char* const path = std::getenv("SHVR_FAULTS_NOW");
    if (!path) return;
    std::ifstream file(path);
    if (!file) return;
    std::ostringstream text;
    text << file.rdbuf();
    std::remove(path);
    known.faults = faults_of(text.str());
    for (uint64_t& count : known.counts) count = 0;
}

/// Returns the result of a call that must not reach the driver, or VK_SUCCESS.
VkResult fault_for(size_t call)
{
    State& known = state();
    look_for_faults(known);
    const uint64_t number = ++known.counts[call];
    for (Fault& fault : known.faults) {
        if (fault.call != call || fault.has_fired) continue;
        if (fault.goes_on ? number < fault.number : number != fault.number) continue;
        fault.has_fired = !fault.goes_on;
        if (number == fault.number)
            write_log(std::string("fired ") + NAMES[call] + ' ' + std::to_string(number) + ' ' + fault.error.name);
        return fault.error.result;
    }
    return VK_SUCCESS;
}

template <size_t CALL, class First, class... Rest>
VKAPI_ATTR VkResult VKAPI_CALL device_call(First first, Rest... rest)
{
    State& known = state();
    PFN_vkVoidFunction next = nullptr, wait = nullptr;
    VkDevice device = VK_NULL_HANDLE;
    VkResult fault = VK_SUCCESS;
    {
        const std::lock_guard lock(known.mutex);
        State::Device& owner = known.devices[table_of(first)];
        next = owner.calls[CALL];
        wait = owner.calls[CALL_vkDeviceWaitIdle];
        device = owner.handle;
        fault = fault_for(CALL);
        if (fault == VK_ERROR_DEVICE_LOST) owner.is_lost = true;
        const bool tells =
            std::find(std::begin(TELL_OF_LOSS), std::end(TELL_OF_LOSS), Call(CALL)) != std::end(TELL_OF_LOSS);
        if (owner.is_lost && tells) fault = VK_ERROR_DEVICE_LOST;
    }
    if (fault == VK_ERROR_DEVICE_LOST) {
        // Running work finishes first, so that the driver may free what the program destroys.
        static_cast<void>(reinterpret_cast<PFN_vkDeviceWaitIdle>(wait)(device));
        return fault;
    }
    if (fault < 0 || fault == VK_NOT_READY) return fault;
    const VkResult result = reinterpret_cast<VkResult(VKAPI_PTR*)(First, Rest...)>(next)(first, rest...);
    if (result != VK_SUCCESS) return result;
    const std::lock_guard lock(known.mutex);
    // Dear ImGui's pipeline, too.
    ++known.alive[CALL == CALL_vkCreateGraphicsPipelines ? size_t{CALL_vkCreateComputePipelines} : CALL];
    return fault;
}

template <class Handle, size_t MADE_BY>
VKAPI_ATTR void VKAPI_CALL end_call(VkDevice device, Handle handle, const VkAllocationCallbacks* allocator)
{
    State& known = state();
    PFN_vkVoidFunction next = nullptr;
    {
        const std::lock_guard lock(known.mutex);
        State::Device& owner = known.devices[table_of(device)];
        next = owner.ends[MADE_BY];
        if (handle) --known.alive[MADE_BY];
    }
    reinterpret_cast<void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*)>(next)(device, handle, allocator);
}

template <size_t CALL, class First, class... Rest>
VKAPI_ATTR VkResult VKAPI_CALL instance_call(First first, Rest... rest)
{
    State& known = state();
    PFN_vkVoidFunction next = nullptr;
    VkResult fault = VK_SUCCESS;
    {
        const std::lock_guard lock(known.mutex);
        next = known.instances.back().calls[CALL];
        fault = fault_for(CALL);
    }
    if (fault < 0) return fault;
    return reinterpret_cast<VkResult(VKAPI_PTR*)(First, Rest...)>(next)(first, rest...);
}

/// The arguments of an entry point's type are those of its hook.
template <size_t CALL, class First, class... Rest>
constexpr PFN_vkVoidFunction hook(VkResult(VKAPI_PTR*)(First, Rest...))
{
    if constexpr (CALL < DEVICE_CALLS)
        return reinterpret_cast<PFN_vkVoidFunction>(&device_call<CALL, First, Rest...>);
    else
        return reinterpret_cast<PFN_vkVoidFunction>(&instance_call<CALL, First, Rest...>);
}

PFN_vkVoidFunction hook_named(const char* name)
{
#define SHVR_HOOK(call)                                                                                                \
    if (std::strcmp(name, #call) == 0) return hook<CALL_##call>(PFN_##call(nullptr));
    SHVR_DEVICE_CALLS(SHVR_HOOK)
    SHVR_INSTANCE_CALLS(SHVR_HOOK)
#undef SHVR_HOOK
#define SHVR_END(call, handle, made_by)                                                                                \
    if (std::strcmp(name, #call) == 0) return reinterpret_cast<PFN_vkVoidFunction>(&end_call<handle, CALL_##made_by>);
    SHVR_ENDS(SHVR_END)
#undef SHVR_END
    return nullptr;
}

// ---- What makes it a layer ------------------------------------------------------------------------------------------

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                               VkInstance* instance)
{
    auto* const link = link_in<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    if (!link) return VK_ERROR_INITIALIZATION_FAILED;
    const PFN_vkGetInstanceProcAddr next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkResult result = create(info, allocator, instance);
    if (result != VK_SUCCESS) return result;
    State& known = state();
    const std::lock_guard lock(known.mutex);
    State::Instance& made = known.instances.emplace_back();
    made = {.next = next, .handle = *instance};
    // Queried now: if asked later, the loader gives the last layer the first one's calls.
    for (size_t call = DEVICE_CALLS; call < CALLS; ++call) made.calls[call] = next(*instance, NAMES[call]);
    made.destroy = reinterpret_cast<PFN_vkDestroyInstance>(next(*instance, "vkDestroyInstance"));
    // A program that re-creates its device re-creates its instance, too: faults that fired do not fire again.
    static const bool is_first = [&] {
        const char* const text = std::getenv("SHVR_FAULTS");
        known.faults = faults_of(text ? text : "");
        return true;
    }();
    static_cast<void>(is_first);
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* allocator)
{
    if (!instance) return;
    State& known = state();
    PFN_vkDestroyInstance destroy = nullptr;
    {
        const std::lock_guard lock(known.mutex);
        for (size_t call = 0; call < CALLS; ++call)
            if (known.counts[call] > 0) write_log(std::string(NAMES[call]) + ' ' + std::to_string(known.counts[call]));
#define SHVR_LEAK(call, handle, made_by)                                                                               \
    if (known.alive[CALL_##made_by] != 0)                                                                              \
        write_log("leaked " #made_by " " + std::to_string(known.alive[CALL_##made_by]));
        SHVR_ENDS(SHVR_LEAK)
#undef SHVR_LEAK
        const auto found = std::ranges::find(known.instances, instance, &State::Instance::handle);
        destroy = found->destroy;
        known.instances.erase(found);
    }
    destroy(instance, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator, VkDevice* device)
{
    auto* const link = link_in<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    if (!link) return VK_ERROR_INITIALIZATION_FAILED;
    const PFN_vkGetInstanceProcAddr next_of_instance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    const PFN_vkGetDeviceProcAddr next = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    State& known = state();
    VkInstance instance = VK_NULL_HANDLE;
    {
        const std::lock_guard lock(known.mutex);
        instance = known.instances.back().handle;
    }
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(next_of_instance(instance, "vkCreateDevice"));
    const VkResult result = create(physical, info, allocator, device);
    if (result != VK_SUCCESS) return result;
    const std::lock_guard lock(known.mutex);
    State::Device& made = known.devices[table_of(*device)];
    made = {.next = next, .handle = *device};
    for (size_t call = 0; call < DEVICE_CALLS; ++call) made.calls[call] = next(*device, NAMES[call]);
#define SHVR_NEXT_END(call, handle, made_by) made.ends[CALL_##made_by] = next(*device, #call);
    SHVR_ENDS(SHVR_NEXT_END)
#undef SHVR_NEXT_END
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* allocator)
{
    if (!device) return;
    State& known = state();
    PFN_vkDestroyDevice destroy = nullptr;
    {
        const std::lock_guard lock(known.mutex);
        const auto found = known.devices.find(table_of(device));
        destroy = reinterpret_cast<PFN_vkDestroyDevice>(found->second.next(device, "vkDestroyDevice"));
        known.devices.erase(found);
    }
    destroy(device, allocator);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_call(VkDevice device, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&get_device_call);
    if (std::strcmp(name, "vkDestroyDevice") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&destroy_device);
    PFN_vkGetDeviceProcAddr next = nullptr;
    {
        State& known = state();
        const std::lock_guard lock(known.mutex);
        const auto found = known.devices.find(table_of(device));
        if (found != known.devices.end()) next = found->second.next;
    }
    const PFN_vkVoidFunction there = next ? next(device, name) : nullptr;
    const PFN_vkVoidFunction hooked = hook_named(name);
    return hooked && there ? hooked : there;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_call(VkInstance instance, const char* name)
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
        State& known = state();
        const std::lock_guard lock(known.mutex);
        const auto found = std::ranges::find(known.instances, instance, &State::Instance::handle);
        if (found != known.instances.end()) next = found->next;
    }
    const PFN_vkVoidFunction there = next ? next(instance, name) : nullptr;
    const PFN_vkVoidFunction hooked = hook_named(name);
    return hooked && there ? hooked : there;
}

}  // namespace

extern "C" VKAPI_ATTR VkResult VKAPI_CALL faults_negotiate(VkNegotiateLayerInterface* interface)
{
    interface->loaderLayerInterfaceVersion = 2;
    interface->pfnGetInstanceProcAddr = get_instance_call;
    interface->pfnGetDeviceProcAddr = get_device_call;
    interface->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
