#pragma once
// A volume that is wholly on the device: its bricks in the atlas, the page table, the value range of every cell and the leap
// grid. A volume whose bricks do not fit the device budget is refused in words before any is read.
//
// One thread, the one that owns the executor.

#include "engine/device/device_volume.h"
#include "engine/gpu/executor.h"
#include "engine/passes/leap_grid.h"

namespace shvr {

class ResidentVolume final : public DeviceVolume {
public:
    /// Reads, encodes and uploads every brick, on `threads` workers. `filtered` chooses the atlas (VolumeBinding).
    ResidentVolume(gpu::Executor& executor, gpu::Memory& memory, const VolumeSource& source,
                   const IntensityWindow& window, bool filtered, int threads);

    /// Device memory that the bricks of such a volume take, cells and leap grid included.
    static uint64_t bytes_for(const VolumeInfo& info);

    uint64_t brick_count() const;
    /// Handles for a new frame graph.
    VolumeBinding import(FrameGraph& graph) const;
    VolumeBinding atlas(FrameGraph& graph) const override { return import(graph); }
    std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) override;
    int levels() const override { return 1; }
    glm::uvec3 atlas_slots() const override { return atlas_slots_; }
    std::vector<Place> places() const override;
    uint64_t places_revision() const override { return places_revision_; }
    /// `source` hands out other voxels in these boxes: bricks that see them are cut anew and sent in place of the old
    /// ones. Waits for reads, and for the device where there are many; frames submitted later see them.
    void renew(const VolumeSource& source, std::span<const VoxelBox> changed);

private:
    struct Renewal {
        gpu::Storage staging;
        gpu::Submission copy;
    };
    gpu::Executor& executor_;
    gpu::Memory& memory_;
    bool filtered_;
    glm::uvec3 brick_counts_{1}, cell_counts_{1}, atlas_slots_{1};
    gpu::Storage atlas_, page_table_, cell_ranges_, leap_;
    std::array<gpu::Storage, 2> leap_scratch_;
    std::vector<BrickTexels::Range> ranges_;  ///< by brick
    uint64_t places_revision_ = 1;
    std::vector<Renewal> renewals_;  ///< that the device may still copy from
};

}  // namespace shvr
