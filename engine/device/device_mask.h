#pragma once
// The painted voxels in device memory: a copy of the mask's bricks, updated brick by brick. Memory is allocated when
// the first voxel is painted and freed when the last paint is removed.

#include <map>
#include <optional>
#include <span>

#include "engine/annotation/mask.h"
#include "engine/gpu/executor.h"
#include "engine/passes/volume_binding.h"

namespace shvr {

class DeviceMask {
public:
    /// `hashed`: whether the device has a hash table of the painted bricks only (shaders/library/mask.glsl).
    DeviceMask(gpu::Executor& executor, gpu::Memory& memory, bool hashed)
        : executor_(executor), memory_(memory), hashed_(hashed)
    {}

    /// Minimum device memory of a mask that has this many painted bricks.
    static uint64_t bytes_for(uint64_t painted_bricks);
    /// Uploads `bricks`, the changed bricks of `mask`; grows the atlas if they do not fit. Does not wait; frames
    /// submitted later show the change. On failure the device holds no mask, and the next update uploads everything.
    void update(const Mask& mask, std::span<const int64_t> bricks);

    /// The slot of a painted brick; gpu::NO_SLOT if it is not on the device.
    uint32_t slot_of(int64_t brick) const;
    bool empty() const { return slots_.empty(); }
    bool is_stale() const { return is_stale_; }
    /// The voxel box of each painted brick, in a volume of `size`.
    std::vector<VoxelBox> bricks(const Size3& size) const;
    /// The mask's handles for `graph`; null while nothing is painted.
    std::optional<MaskBinding> import(FrameGraph& graph) const;

private:
    void clear();
    void send(const Mask& mask, std::span<const int64_t> bricks);
    bool give_slots(const Mask& mask, std::span<const int64_t> bricks);
    void send_bricks(const Mask& mask, std::span<const int64_t> bricks);
    void send_table(const Mask& mask);
    void grow(uint64_t bricks);
    std::optional<ResourceDesc> desc_for(uint64_t bricks) const;
    void submit(FrameGraph graph);
    std::vector<uint32_t> dense_table(const Mask& mask) const;
    std::vector<uint32_t> hashed_table(const Mask& mask) const;
    gpu::Executor& executor_;
    gpu::Memory& memory_;
    bool hashed_;
    std::map<int64_t, uint32_t> slots_;  ///< painted brick -> slot (gpu::pack_slot), never NO_SLOT
    std::vector<uint32_t> free_slots_;
    gpu::Storage atlas_, table_;
    std::vector<gpu::Submission> in_flight_;
    bool is_stale_ = false;       ///< an update failed
    bool is_table_stale_ = true;  ///< slots were assigned or released since the table was uploaded
};

}  // namespace shvr
