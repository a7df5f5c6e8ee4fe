#pragma once
// A volume on the device: wholly there (resident_volume.h), or as bricks that come and go (paged_volume.h).
//
// One thread, the one that owns the executor.

#include <optional>
#include <span>
#include <vector>

#include "engine/bricks/brick_builder.h"
#include "engine/passes/volume_binding.h"

namespace shvr {

/// How many bricks an atlas holds along each axis, at least `slots` in all. Slots fill a row of bricks first; narrow
/// rows keep a brick's texels close in memory on devices with linear images.
glm::uvec3 atlas_layout(uint64_t slots, uint32_t brick_texels, uint32_t max_side, bool narrow);

/// The packed address of the slot of that index, x fastest.
uint32_t slot_at(uint32_t index, const glm::uvec3& slots);

/// The bricks of a level whose texels, aprons included, depend on voxels of level 0 in one of the boxes; each once.
std::vector<BrickKey> bricks_that_see(std::span<const VoxelBox> boxes, const Size3& size, int level);

/// The bricks of level 0 that hold a box of voxels, without their slots.
RegionBricks bricks_around(const VoxelBox& voxels);

class DeviceVolume {
public:
    /// A brick that has a slot, for work on all that are there.
    struct Place {
        BrickKey key;
        uint32_t slot = 0;         ///< packed
        BrickTexels::Range range;  ///< of its codes
    };

    virtual ~DeviceVolume() = default;
    DeviceVolume(const DeviceVolume&) = delete;
    DeviceVolume& operator=(const DeviceVolume&) = delete;

    const VolumeInfo& info() const { return info_; }
    const IntensityWindow& window() const { return window_; }

    virtual int levels() const = 0;
    /// Slots of the atlas along each axis.
    virtual glm::uvec3 atlas_slots() const = 0;
    /// Every brick on the device, and a number that changes when they do.
    virtual std::vector<Place> places() const = 0;
    virtual uint64_t places_revision() const = 0;

    /// What kernels bind that work on a region of level 0.
    virtual VolumeBinding atlas(FrameGraph& graph) const = 0;
    /// The bricks of a box of voxels, which stay where they are until the next call. Null where some are not there yet;
    /// they are wanted before all others. `wait`: reads them now, and fails where that cannot be.
    virtual std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) = 0;

protected:
    DeviceVolume(VolumeInfo info, const IntensityWindow& window) : info_(std::move(info)), window_(window) {}

private:
    VolumeInfo info_;
    IntensityWindow window_;
};

}  // namespace shvr
