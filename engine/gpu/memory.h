#pragma once
// Device memory with accounting: every buffer and image has a name, its bytes are counted by name, and two budgets
// (device, host) are hard limits. Every allocation is checked against its budget first; where it does not fit, idle
// memory is freed.
//
// One thread at a time.

#include <functional>
#include <map>
#include <span>
#include <string>
#include <unordered_map>

#include "engine/gpu/device.h"
#include "engine/graph/frame_graph.h"

namespace shvr::gpu {

enum class Placement {
    device,    ///< where the device is fastest; counts against the device budget
    upload,    ///< mapped, written by the host; host budget
    download,  ///< mapped and cached, read by the host; host budget
};

struct Budget {
    uint64_t device_bytes = 0;  ///< 0: three quarters of the device's memory
    uint64_t host_bytes = 0;    ///< 0: 1 GiB of mapped memory
};

/// A budget does not hold what is needed; the message names the budget and a remedy.
class BudgetError : public Error {
public:
    using Error::Error;
};

/// "1.5 MiB", rounded up to a tenth.
std::string mebibytes(uint64_t bytes);

class Memory;

/// A buffer or an image with its own memory. Move-only; its destructor waits for the device.
class Storage {
public:
    Storage() = default;
    ~Storage() { reset(); }
    Storage(Storage&& other) noexcept { *this = std::move(other); }
    Storage& operator=(Storage&& other) noexcept;

    explicit operator bool() const { return memory_ != nullptr; }
    const ResourceDesc& desc() const;
    /// What a frame graph needs to import it; the state is the one that the last submitted frame left.
    Import import() const;
    /// The mapped bytes of an upload or download buffer.
    std::span<std::byte> mapped() const;
    void reset();
    /// As reset(), for callers that know the device is idle.
    void reset_idle();

private:
    friend class Memory;
    Storage(Memory& memory, uint32_t id) : memory_(&memory), id_(id) {}
    Memory* memory_ = nullptr;
    uint32_t id_ = 0;
};

class Memory {
public:
    Memory(Device& device, const Budget& budget = {});
    ~Memory();
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    /// Throws BudgetError if the budget cannot hold it. `purpose`: what it is for, in the user's words.
    Storage create(const std::string& name, const ResourceDesc& desc, Placement placement = Placement::device,
                   const char* purpose = "a step of the work");
    /// Set a function that frees memory which is allocated and idle; it is called before a budget refuses.
    void free_idle_by(std::function<void()> free_idle) { free_idle_ = std::move(free_idle); }
    void free_idle();

    /// Vulkan's side of a storage, for the executor.
    struct Object {
        std::string name;
        ResourceDesc desc;
        Placement placement = Placement::device;
        VkBuffer buffer = VK_NULL_HANDLE;
        VkImage image = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
        uint64_t bytes = 0;  ///< as counted by the device
        std::byte* mapped = nullptr;
        bool in_general_layout = false;
        ResourceState state;  ///< what the last submitted frame left in flight
    };
    Object& object(uint32_t id);

    uint64_t device_bytes() const { return device_bytes_; }
    uint64_t host_bytes() const { return host_bytes_; }
    uint64_t peak_device_bytes() const { return peak_device_bytes_; }
    uint64_t peak_host_bytes() const { return peak_host_bytes_; }
    uint64_t device_budget() const { return budget_.device_bytes; }
    uint64_t device_bytes_left() const { return budget_.device_bytes - device_bytes_; }
    uint64_t host_bytes_left() const { return budget_.host_bytes - host_bytes_; }
    std::map<std::string, uint64_t> bytes_by_name() const;
    Device& device() { return device_; }

private:
    friend class Storage;
    void wait_idle() const noexcept;
    void release(uint32_t id) noexcept;
    void allocate(Object& object, const VkMemoryRequirements& needs, const char* purpose);
    [[noreturn]] void refuse(bool on_device, uint64_t bytes, const char* purpose) const;
    void destroy(Object& object) noexcept;

    Device& device_;
    Budget budget_;
    std::unordered_map<uint32_t, Object> objects_;
    uint32_t next_id_ = 1;
    uint64_t device_bytes_ = 0, host_bytes_ = 0;
    uint64_t peak_device_bytes_ = 0, peak_host_bytes_ = 0;
    std::function<void()> free_idle_;
};

VkFormat vulkan_format(Format format);

}  // namespace shvr::gpu
