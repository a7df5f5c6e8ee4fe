#pragma once
// The Vulkan device: instance, physical device, one queue, capabilities, names for its objects, and the validation
// layer's messages. Only Vulkan 1.3 is required; optional features are probed here and reported in `traits`.
//
// One thread at a time may use a device. Validation messages may arrive on any thread and are collected under a lock.

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "engine/base/error.h"

namespace shvr::gpu {

/// The device stopped answering: its driver was reset, or it was taken away. All that was on it is gone, and every
/// later call fails likewise, until the device is made anew.
class DeviceLost : public Error {
public:
    using Error::Error;
};

/// There is not the memory that is needed: the driver has none left, or a budget (memory.h) does not hold it.
class MemoryError : public Error {
public:
    using Error::Error;
};

/// Throws `Error`, naming the call and the result, if `result` is a failure; `DeviceLost` or `MemoryError`, if it is
/// that.
void check(VkResult result, const char* call);
#define SHVR_VK(call) ::shvr::gpu::check(call, #call)

struct DeviceOptions {
    std::string device;        ///< part of the device's name, or its index; empty: $SHVR_DEVICE, else the best
    bool validation = false;   ///< Khronos layer with synchronisation validation; fails where it is not installed
    bool looks_ahead = false;  ///< on a GPU, compiles what graphs expect later ones to run (FrameGraph::expect)
    /// What is read beside a buffer is 0 or of that buffer, and nothing is written there. Validation that looks for
    /// such accesses finds none with it.
    bool robust_buffers = true;
    std::vector<std::string> instance_extensions;  ///< those for a window's surface; if any, the device can present
    /// Whether a queue of a family can show pictures in the window; null: nobody asks.
    std::function<bool(VkInstance, VkPhysicalDevice, uint32_t family)> can_present{};
};

/// Device properties for the rest of the program.
struct DeviceTraits {
    std::string name;
    std::string driver;   ///< name and version
    bool is_cpu = false;  ///< lavapipe and other software devices
    /// Of a software device: each takes an equal run of a dispatch's workgroups (lavapipe's do, in the order of their
    /// numbers), and the dispatch ends with the slowest.
    uint32_t cpu_threads = 1;
    bool is_integrated = false;      ///< it shares the host's memory
    float nanoseconds_per_tick = 0;  ///< 0: no timestamps
    uint32_t timestamp_bits = 0;
    bool has_pipeline_statistics = false;
    bool linear_r16 = false;   ///< R16_UNORM can be filtered by the sampler
    bool storage_r16 = false;  ///< R16_UNORM can be read with imageLoad
    /// The largest device-local heap, as reported; where the device is integrated, the largest heap.
    uint64_t device_bytes = 0;
    VkPhysicalDeviceLimits limits{};
    uint64_t max_allocation_bytes = 0;  ///< of one buffer or image, as its memory is one allocation
    uint64_t max_buffer_bytes = 0;
    uint64_t max_volume_bytes = 0;     ///< of a 3-D image of codes; no more than one allocation holds
    bool tells_memory_left = false;    ///< VK_EXT_memory_budget
    bool tells_faults = false;         ///< VK_EXT_device_fault
    bool has_memory_priority = false;  ///< VK_EXT_memory_priority
};

/// For Vulkan calls that are made twice, first for the count and then for the items: returns the items.
template <class T, class Call>
std::vector<T> enumerate(Call call)
{
    uint32_t count = 0;
    call(&count, nullptr);
    std::vector<T> items(count);
    call(&count, items.data());
    items.resize(count);
    return items;
}

class Device {
public:
    explicit Device(const DeviceOptions& options = {});
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkDevice handle() const { return device_; }
    VkQueue queue() const { return queue_; }
    uint32_t queue_family() const { return queue_family_; }
    const DeviceTraits& traits() const { return traits_; }
    bool looks_ahead() const { return looks_ahead_; }
    const VkPhysicalDeviceMemoryProperties& memory_properties() const { return memory_properties_; }
    /// How much of the heap of `device_bytes` the driver would still give this program, beside all others; null where
    /// it does not tell.
    std::optional<uint64_t> heap_bytes_left() const;

    /// Names an object for validation messages, captures and traces.
    void set_name(VkObjectType type, uint64_t handle, const std::string& name) const;
    void begin_label(VkCommandBuffer commands, const std::string& name) const;
    void end_label(VkCommandBuffer commands) const;

    /// As gpu::check, for calls that tell of a lost device: with what its driver says of it.
    void check(VkResult result, const char* call) const;

    /// Waits for all that was submitted. The second one does so where nobody can be told that it failed.
    void wait_idle();
    void wait_idle_or_lost() noexcept;

    // The queue ends submissions in the order in which they came, whoever made them. Who submits takes a number for it
    // afterwards, and says once its fence is seen signalled: so everybody knows what the device is done with.
    uint64_t note_submission() { return ++submitted_; }
    void note_done(uint64_t number) { done_ = std::max(done_, number); }
    uint64_t submitted() const { return submitted_; }
    uint64_t done() const { return done_; }

    /// Messages of the validation layer so far (warnings and errors), oldest first; empties the list.
    std::vector<std::string> take_validation_messages();
    /// Whether the layer looks on.
    bool is_validated() const { return messenger_ != VK_NULL_HANDLE; }

private:
    void create_instance(const DeviceOptions& options);
    void choose_physical(const DeviceOptions& options);
    void read_traits();
    void create_device(const DeviceOptions& options);
    void destroy() noexcept;
    std::string fault_in_words() const;
    static VkBool32 on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

    bool looks_ahead_ = false;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t queue_family_ = 0;
    uint64_t submitted_ = 0, done_ = 0;  ///< numbers of submissions
    DeviceTraits traits_;
    VkPhysicalDeviceMemoryProperties memory_properties_{};
    uint32_t heap_ = 0;  ///< that of traits_.device_bytes
    PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label_ = nullptr;
    PFN_vkCmdEndDebugUtilsLabelEXT end_label_ = nullptr;
    PFN_vkGetDeviceFaultInfoEXT get_fault_ = nullptr;
    std::mutex messages_mutex_;
    std::vector<std::string> messages_;
};

}  // namespace shvr::gpu
