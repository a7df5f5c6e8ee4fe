#pragma once
// An allocation that small buffers share, or small images: drivers allow few allocations, 4096 at least, and take long
// for each. Knows where in it there is room, and nothing of Vulkan but the handle. One thread at a time.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <vulkan/vulkan.h>

namespace shvr::gpu {

enum class Placement {
    device,    ///< where the device is fastest; counts against the device budget
    upload,    ///< mapped, written by the host; host budget
    download,  ///< mapped and cached, read by the host; host budget
    values,    ///< as upload, in the device's own memory where the host can write there: what kernels read often
};

class MemoryBlock {
public:
    static constexpr uint64_t BYTES = uint64_t{1} << 20;
    /// What is larger has an allocation of its own.
    static constexpr uint64_t MAX_SHARE = BYTES / 8;

    MemoryBlock(VkDeviceMemory of, Placement where, bool of_images, uint32_t memory_type, std::byte* begin)
        : memory(of), placement(where), holds_images(of_images), type(memory_type), mapped(begin)
    {}
    /// Where there is room for so many bytes, which are then in use; null: nowhere. `alignment`: a power of two.
    std::optional<uint64_t> take(uint64_t bytes, uint64_t alignment);
    void give_back(uint64_t offset);
    bool is_empty() const { return used_.empty(); }

    const VkDeviceMemory memory;
    const Placement placement;
    const bool holds_images;  ///< alone: beside buffers they would have to keep a distance that devices choose
    const uint32_t type;
    std::byte* const mapped;  ///< null: it is not

private:
    std::map<uint64_t, uint64_t> used_;  ///< begin and end
};

}  // namespace shvr::gpu
