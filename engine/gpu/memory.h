#pragma once
// Device memory with accounting: every buffer and image has a name, its bytes are counted by name, and two budgets
// (device, host) are hard limits. Every allocation is checked against its budget first.
//
// One thread at a time.

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

    /// Fails, naming the resource, its size and what is left, if the budget or the device cannot hold it.
    Storage create(const std::string& name, const ResourceDesc& desc, Placement placement = Placement::device);

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
    std::map<std::string, uint64_t> bytes_by_name() const;
    Device& device() { return device_; }

private:
    friend class Storage;
    void wait_idle() const noexcept;
    void release(uint32_t id) noexcept;
    void allocate(Object& object, const VkMemoryRequirements& needs);
    void destroy(Object& object) noexcept;

    Device& device_;
    Budget budget_;
    std::unordered_map<uint32_t, Object> objects_;
    uint32_t next_id_ = 1;
    uint64_t device_bytes_ = 0, host_bytes_ = 0;
    uint64_t peak_device_bytes_ = 0, peak_host_bytes_ = 0;
};

VkFormat vulkan_format(Format format);

}  // namespace shvr::gpu
