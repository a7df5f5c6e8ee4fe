#pragma once
// The Vulkan device: instance, physical device, one queue, capabilities, names for its objects, and the validation
// layer's messages. Only Vulkan 1.3 is required; optional features are detected here and reported in `traits`.
//
// Used by one thread at a time. Validation messages may arrive on any thread and are collected under a lock.

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

/// The device stopped responding: its driver was reset, or the device was removed. All of its contents are lost, and
/// every later call fails in the same way until the device is re-created.
class DeviceLost : public Error {
public:
    using Error::Error;
};

/// Memory ran out: the driver has none left, or a budget (memory.h) would be exceeded.
class MemoryError : public Error {
public:
    using Error::Error;
};

/// Throws if `result` is a failure: `DeviceLost` after a device loss, `MemoryError` if memory ran out, otherwise
/// `Error`. The message names the call and the result.
void check(VkResult result, const char* call);
#define SHVR_VK(call) ::shvr::gpu::check(call, #call)

struct DeviceOptions {
    std::string device;        ///< part of the device's name, or its index; if empty: $SHVR_DEVICE, or the best device
    bool validation = false;   ///< Khronos layer with synchronisation validation; fails if it is not installed
    bool looks_ahead = false;  ///< on a GPU, compiles in advance the kernels that graphs expect (FrameGraph::expect)
    /// Makes out-of-bounds reads return 0 or data of the same buffer, and discards out-of-bounds writes. Robust access
    /// hides out-of-bounds accesses from the validation layer.
    bool robust_buffers = true;
    std::vector<std::string> instance_extensions;  ///< instance extensions for a window's surface; if any are given,
                                                   ///< the device can present
    /// Whether a queue family can present to the window; null: presentation is not required.
    std::function<bool(VkInstance, VkPhysicalDevice, uint32_t family)> can_present{};
};

/// Device properties for the rest of the program.
struct DeviceTraits {
    std::string name;
    std::string driver;   ///< name and version
    bool is_cpu = false;  ///< lavapipe and other software devices
    /// Number of threads of a software device. Each thread runs an equal, contiguous share of a dispatch's workgroups
    /// (lavapipe: in index order), so a dispatch takes as long as its slowest thread.
    uint32_t cpu_threads = 1;
    bool is_integrated = false;      ///< whether the device shares the host's memory
    float nanoseconds_per_tick = 0;  ///< 0: no timestamps
    uint32_t timestamp_bits = 0;
    bool has_pipeline_statistics = false;
    bool linear_r16 = false;   ///< R16_UNORM can be filtered by the sampler
    bool storage_r16 = false;  ///< R16_UNORM can be read with imageLoad
    /// Size of the largest device-local heap; on integrated devices, size of the largest heap of any kind.
    uint64_t device_bytes = 0;
    VkPhysicalDeviceLimits limits{};
    uint64_t max_allocation_bytes = 0;  ///< limit of one buffer or image, since each needs one contiguous allocation
    uint64_t max_buffer_bytes = 0;
    uint64_t max_volume_bytes = 0;     ///< limit of a 3-D image of voxel codes; at most max_allocation_bytes
    bool tells_memory_left = false;    ///< VK_EXT_memory_budget
    bool tells_faults = false;         ///< VK_EXT_device_fault
    bool has_memory_priority = false;  ///< VK_EXT_memory_priority
    bool reads_by_address = false;     ///< exact densities are in a buffer (keeps_atlas_in_buffer)
};

/// Returns the items of a Vulkan query that is called twice: first for the number of items, then for the items.
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
    /// Free bytes of the heap whose size is `device_bytes`: the bytes that the driver still grants this program, given
    /// the usage of other programs. Null if the driver does not report this.
    std::optional<uint64_t> heap_bytes_left() const;

    /// Names an object for validation messages, captures and traces.
    void set_name(VkObjectType type, uint64_t handle, const std::string& name) const;
    void begin_label(VkCommandBuffer commands, const std::string& name) const;
    void end_label(VkCommandBuffer commands) const;

    /// Like gpu::check, for calls that can report a lost device: the message includes the driver's fault report.
    void check(VkResult result, const char* call) const;

    /// Waits for all submitted work. wait_idle_or_lost() is for callers that cannot handle a failure.
    void wait_idle();
    void wait_idle_or_lost() noexcept;

    // The queue completes submissions in submission order across all submitters. Each submitter takes a number right
    // after submitting, and reports the number when the fence is signalled. All users of the device thus know its
    // progress.
    uint64_t note_submission() { return ++submitted_; }
    void note_done(uint64_t number) { done_ = std::max(done_, number); }
    uint64_t submitted() const { return submitted_; }
    uint64_t done() const { return done_; }

    /// Returns the validation layer's collected messages (warnings and errors), oldest first, and clears the list.
    std::vector<std::string> take_validation_messages();
    /// Whether the validation layer is active.
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
    uint32_t heap_ = 0;  ///< the heap counted in traits_.device_bytes
    PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label_ = nullptr;
    PFN_vkCmdEndDebugUtilsLabelEXT end_label_ = nullptr;
    PFN_vkGetDeviceFaultInfoEXT get_fault_ = nullptr;
    std::mutex messages_mutex_;
    std::vector<std::string> messages_;
};

}  // namespace shvr::gpu
