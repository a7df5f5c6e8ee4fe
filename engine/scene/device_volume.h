#pragma once
// A volume on the device: its bricks in the atlas, the page table, the value range of every cell and the leap grid.
// Everything is resident; a volume whose bricks do not fit the device budget is refused in words before any is read.
//
// One thread, the one that owns the executor.

#include "engine/gpu/executor.h"
#include "engine/passes/leap_grid.h"
#include "engine/volume/brick_builder.h"

namespace shvr {

/// How many bricks an atlas holds along each axis, at least `slots` in all. Slots fill a row of bricks first; narrow
/// rows keep a brick's texels close in memory on devices with linear images.
glm::uvec3 atlas_layout(uint64_t slots, uint32_t brick_texels, uint32_t max_side, bool narrow);

/// The packed address of the slot of that index, x fastest.
uint32_t slot_at(uint32_t index, const glm::uvec3& slots);

class DeviceVolume {
public:
    /// Reads, encodes and uploads every brick, on `threads` workers. `filtered` chooses the atlas (VolumeBinding).
    DeviceVolume(gpu::Executor& executor, gpu::Memory& memory, const VolumeSource& source,
                 const IntensityWindow& window, bool filtered, int threads);

    const IntensityWindow& window() const { return window_; }
    const VolumeInfo& info() const { return info_; }
    uint64_t brick_count() const;
    /// Handles for a new frame graph.
    VolumeBinding import(FrameGraph& graph) const;

private:
    VolumeInfo info_;
    IntensityWindow window_;
    bool filtered_;
    glm::uvec3 brick_counts_{1}, cell_counts_{1}, atlas_slots_{1};
    gpu::Storage atlas_, page_table_, cell_ranges_, leap_;
    std::array<gpu::Storage, 2> leap_scratch_;
};

}  // namespace shvr
