#pragma once
// An allocation shared by small buffers, or by small images, since drivers limit the number of allocations (some to
// 4096) and take long for each. Tracks free ranges; uses nothing of Vulkan but the handle. One thread at a time.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <vulkan/vulkan.h>

namespace shvr::gpu {

enum class Placement {
    device,    ///< memory with the fastest device access; counts against the device budget
    upload,    ///< mapped memory that the host writes; counts against the host budget
    download,  ///< mapped and cached memory that the host reads; counts against the host budget
    values,    ///< like upload, but in host-writable device memory if available, for data that kernels read often
};

class MemoryBlock {
public:
    static constexpr uint64_t BYTES = uint64_t{1} << 20;
    /// Maximum size of a resource in a shared block; larger resources have their own allocation.
    static constexpr uint64_t MAX_SHARE = BYTES / 8;

    MemoryBlock(VkDeviceMemory of, Placement where, bool of_images, uint32_t memory_type, std::byte* begin)
        : memory(of), placement(where), holds_images(of_images), type(memory_type), mapped(begin)
    {}
    /// Allocates `bytes` and returns their offset; null if they do not fit. `alignment`: a power of two.
    std::optional<uint64_t> take(uint64_t bytes, uint64_t alignment);
    void give_back(uint64_t offset);
    bool is_empty() const { return used_.empty(); }

    const VkDeviceMemory memory;
    const Placement placement;
    const bool holds_images;  ///< true: holds images only; next to buffers, images need a device-specific distance
                              ///< (bufferImageGranularity)
    const uint32_t type;
    std::byte* const mapped;  ///< null: not mapped

private:
    std::map<uint64_t, uint64_t> used_;  ///< end of each used range, keyed by its beginning
};

}  // namespace shvr::gpu
