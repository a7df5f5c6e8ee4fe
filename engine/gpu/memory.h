#pragma once
// Device memory with accounting: every buffer and image has a name, its bytes are counted by name, and two budgets
// (device, host) are hard limits. Every allocation is first checked against its budget. If the budget or the driver
// lacks memory, idle memory is freed. Drivers limit the number of allocations, so small buffers share allocations
// (memory_block.h), as do small images. Memory released while the device may still use it is freed once the device is
// done; callers wait for the device only if they need the bytes at once.
//
// Used by one thread at a time.

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/memory_block.h"
#include "engine/graph/frame_graph.h"

namespace shvr::gpu {

struct Budget {
    uint64_t device_bytes = 0;  ///< 0: automatic_device_bytes()
    uint64_t host_bytes = 0;    ///< 0: 1 GiB of mapped memory
};

/// Returns three quarters of the device's memory, or half if the memory is shared with the host, but at most `left`:
/// the bytes that other programs leave free according to the driver.
uint64_t automatic_device_bytes(const DeviceTraits& traits, std::optional<uint64_t> left);

/// An allocation would exceed the budget. The message names the budget and a solution.
class BudgetError : public MemoryError {
public:
    using MemoryError::MemoryError;
};

/// Returns the memory types, best first, that suit a placement and that a resource allows.
std::vector<uint32_t> memory_types(const VkPhysicalDeviceMemoryProperties& properties, uint32_t allowed,
                                   Placement placement);

/// Returns the priority, 0 to 1 (VK_EXT_memory_priority), for keeping a resource in device memory when other programs
/// leave too little. Data that rays read repeatedly ranks above pictures, which are written once.
float memory_priority(const ResourceDesc& desc, Placement placement);

/// Returns a size as text, such as "1.5 MiB", rounded up to a tenth.
std::string mebibytes(uint64_t bytes);

class Memory;

/// A buffer or an image that owns its memory. Move-only. May be destroyed while the device still uses it; the
/// destructor never waits.
class Storage {
public:
    Storage() = default;
    ~Storage() { reset(); }
    Storage(Storage&& other) noexcept { *this = std::move(other); }
    Storage& operator=(Storage&& other) noexcept;

    explicit operator bool() const { return memory_ != nullptr; }
    const ResourceDesc& desc() const;
    /// Returns the import for a frame graph, including the state in which the last submitted frame leaves the object.
    Import import() const;
    /// The mapped bytes of an upload or download buffer.
    std::span<std::byte> mapped() const;
    void reset();
    /// Like reset(), for storage that no submission in flight uses; callers must ensure this.
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

    /// Returns why the device can never hold such a resource, even if all memory is free; null if it can.
    std::optional<std::string> why_not(const std::string& name, const ResourceDesc& desc,
                                       Placement placement = Placement::device) const;
    bool can_create(const ResourceDesc& desc) const { return !why_not("", desc); }
    /// Throws BudgetError if the budget is too small, MemoryError if the driver lacks memory, and Error if the device
    /// can never hold the resource (`why_not`). `purpose`: use of the memory, in the user's terms.
    Storage create(const std::string& name, const ResourceDesc& desc, Placement placement = Placement::device,
                   const char* purpose = "a step of the work");
    /// Sets a function that frees allocated but unused memory. It is called before an allocation is refused.
    void free_idle_by(std::function<void()> free_idle) { free_idle_ = std::move(free_idle); }
    void free_idle();

    /// The Vulkan objects of a storage, for the executor.
    struct Object {
        std::string name;
        ResourceDesc desc;
        Placement placement = Placement::device;
        VkBuffer buffer = VK_NULL_HANDLE;
        VkImage image = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
        uint64_t offset = 0;           ///< offset in `memory`
        MemoryBlock* block = nullptr;  ///< the block that contains `memory`; null: the object has its own memory
        uint64_t bytes = 0;            ///< as counted against the budget
        VkDeviceAddress address = 0;   ///< only of words (ResourceDesc::by_address)
        std::byte* mapped = nullptr;
        bool in_general_layout = false;
        ResourceState state;  ///< accesses that the last submitted frame leaves in flight
    };
    Object& object(uint32_t id);

    /// Frees released memory that is no longer in use.
    void collect() noexcept;

    // Released memory counts as free, although an allocation that needs it must wait until the device is done with it.
    uint64_t device_bytes() const { return device_bytes_ - retired_device_bytes_; }
    uint64_t host_bytes() const { return host_bytes_ - retired_host_bytes_; }
    uint64_t peak_device_bytes() const { return peak_device_bytes_; }
    uint64_t peak_host_bytes() const { return peak_host_bytes_; }
    uint64_t device_budget() const { return budget_.device_bytes; }
    uint64_t device_bytes_left() const { return budget_.device_bytes - device_bytes(); }
    uint64_t host_bytes_left() const { return budget_.host_bytes - host_bytes(); }
    std::map<std::string, uint64_t> bytes_by_name() const;
    /// Number of driver allocations that exist now, and total number of allocations made.
    uint64_t allocations() const { return allocations_; }
    uint64_t allocations_made() const { return allocations_made_; }
    Device& device() { return device_; }
    const DeviceTraits& traits() const { return device_.traits(); }

private:
    friend class Storage;
    void release(uint32_t id, bool is_idle) noexcept;
    void free_all_retired() noexcept;
    void create_buffer(Object& object, const char* purpose);
    void create_image(Object& object, const char* purpose);
    void allocate(Object& object, const VkMemoryRequirements& needs, const char* purpose);
    VkResult allocate_from_driver(uint64_t bytes, uint32_t allowed, const Object& object, VkDeviceMemory* memory,
                                  uint32_t* type);
    bool allocate_in_block(Object& object, const VkMemoryRequirements& needs);
    std::byte* map(VkDeviceMemory memory) const;
    void free_to_driver(VkDeviceMemory memory) noexcept;
    [[noreturn]] void refuse(bool on_device, uint64_t bytes, const char* purpose) const;
    void destroy(Object& object) noexcept;

    Device& device_;
    Budget budget_;
    std::unordered_map<uint32_t, Object> objects_;
    struct Retired {
        uint64_t last = 0;  ///< the last submission that may use it
        Object object;
    };
    std::deque<Retired> retired_;
    uint64_t retired_device_bytes_ = 0, retired_host_bytes_ = 0;
    std::vector<std::unique_ptr<MemoryBlock>> blocks_;
    uint64_t allocations_ = 0, allocations_made_ = 0;
    uint32_t next_id_ = 1;
    uint64_t device_bytes_ = 0, host_bytes_ = 0;
    uint64_t peak_device_bytes_ = 0, peak_host_bytes_ = 0;
    std::function<void()> free_idle_;
};

VkFormat vulkan_format(Format format);

}  // namespace shvr::gpu
