#pragma once
// The painted voxels on the device: a copy of the mask's bricks, brought up to date brick by brick. Nothing exists on
// the device while nothing is painted, and it is given back when the last painted voxel goes.

#include <map>
#include <span>

#include "engine/annotation/mask.h"
#include "engine/gpu/executor.h"
#include "engine/passes/volume_binding.h"

namespace shvr {

class DeviceMask {
public:
    DeviceMask(gpu::Executor& executor, gpu::Memory& memory) : executor_(executor), memory_(memory) {}

    /// Sends `bricks` of `mask` (those that changed) to the device; grows the atlas where they do not fit. Does not wait:
    /// frames submitted later see them.
    void update(const Mask& mask, std::span<const int64_t> bricks);

    /// Unpainted again: nothing is left on the device.
    void clear();
    bool empty() const { return slots_.empty(); }
    MaskBinding import(FrameGraph& graph) const;

private:
    void grow(uint64_t slots);
    void submit(FrameGraph graph);
    gpu::Executor& executor_;
    gpu::Memory& memory_;
    glm::uvec3 atlas_slots_{0};
    std::map<int64_t, uint32_t> slots_;  ///< painted brick -> slot, from 1
    std::vector<uint32_t> free_slots_;
    gpu::Storage atlas_, table_;
    std::vector<gpu::Submission> in_flight_;
};

}  // namespace shvr
