#pragma once
// A volume on the device, whichever way it is there: with all of its bricks (resident_volume.h), or with paged ones
// (paged_volume.h). Callers need not know which; a resident volume has little to answer to most questions.
//
// For a picture: look(), prepare(), the passes that draw, request_feedback(); after it take_feedback(); in between
// advance(). One thread, the one that owns the executor.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/bricks/brick_store.h"
#include "engine/bricks/page_tree.h"
#include "engine/device/device_mask.h"
#include "engine/gpu/executor.h"
#include "engine/passes/brick_leap.h"

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

    // ---- What is looked at

    /// From now on this is looked at. Costs nothing where it is the same as before. Returns finest_level().
    virtual int look(const PageView& view, const Visibility& visibility) = 0;
    /// The same from where it is looked at already, if from anywhere, with other things visible.
    virtual void look_by(const Visibility& visibility) = 0;
    /// It is known which bricks the view needs.
    virtual bool has_view() const = 0;
    /// Of the bricks that the view needs; samples may lie as far apart as its voxels.
    virtual int finest_level() const = 0;

    /// A graph of what can be done beforehand of prepare(), one short step at a time; nothing when that is all.
    /// The graph must be submitted before the next call.
    virtual std::optional<FrameGraph> next_preparation(const Visibility& visibility, const DeviceMask& mask) = 0;
    /// Likewise, of what makes pictures of this come sooner without making them different.
    virtual std::optional<FrameGraph> next_refinement(const Visibility& visibility, const DeviceMask& mask) = 0;
    virtual bool refinement_is_due() const = 0;
    /// Adds the passes that bring up to date what rays look into, and returns the handles to draw with. `painted`: the
    /// mask's in that graph. `feedback`: rays record the bricks that they visit.
    virtual VolumeBinding prepare(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& painted,
                                  bool feedback) = 0;
    /// prepare() would upload what has changed since a picture was drawn.
    virtual bool is_stale() const = 0;

    // ---- Which bricks are needed

    /// The bricks that the rays of one picture visited, on their way back from the device.
    class Feedback {
        friend class PagedVolume;
        std::optional<uint32_t> read_back_;
        std::shared_ptr<const PageTree> tree_;  ///< that it was drawn with
    };
    /// Adds the read-back to a graph that was prepared with feedback and has drawn.
    virtual Feedback request_feedback(FrameGraph& graph, const VolumeBinding& volume) const = 0;
    /// `result`: of that graph.
    virtual void take_feedback(const Feedback& feedback, const gpu::FrameResult& result) = 0;
    /// The next picture alone says what is needed.
    virtual void forget_visits() = 0;
    /// Takes the bricks that have been loaded. Returns what may look different now. `wait`: for all that are wanted.
    virtual std::vector<VoxelBox> advance(bool wait = false) = 0;

    enum class State : uint8_t {
        complete,  ///< every brick that rays visited is there
        loading,
        limited,  ///< there is no room for the rest: more is seen than the budget holds
    };
    virtual State state() const = 0;
    /// Bricks that rays visited and that cannot be read; they are drawn from coarser ones.
    virtual size_t missing() const = 0;
    /// Bricks that could not be read, one sentence each, since the last call.
    virtual std::vector<std::string> take_messages() = 0;
    /// Rays visited it, as far as that is known.
    virtual bool is_drawn(const BrickKey& key) const = 0;
    /// Around visited bricks those as far away as `reach` says for their level are needed, too: light arrives from
    /// there. Empty: none.
    virtual void want_around(const std::vector<int>& reach) = 0;
    /// Level 0 of `voxels`, where a person is likely to touch or paint next, is loaded before all else, unless that
    /// takes more than a quarter of the room. Until the next call, or that of region().
    virtual void prefer(const VoxelBox& voxels) = 0;

    // ---- What is changed

    /// The source has other voxels of level 0 in these boxes; what depends on them is renewed. Frames submitted later
    /// see it. Fails where voxels cannot be read.
    virtual void renew(std::span<const VoxelBox> changed) = 0;
    /// These bricks of level 0 have been painted, or are no longer.
    virtual void note_painted(const Mask& mask, std::span<const int64_t> bricks) = 0;

    // ---- Work on level 0, and on all bricks that are there

    virtual int levels() const = 0;
    /// Slots of the atlas along each axis.
    virtual glm::uvec3 atlas_slots() const = 0;
    /// Every brick on the device, and a number that changes when they do.
    virtual std::vector<Place> places() const = 0;
    virtual uint64_t places_revision() const = 0;
    /// Handles for kernels that work on a region of level 0.
    virtual VolumeBinding atlas(FrameGraph& graph) const = 0;
    /// The bricks of a box of voxels, which keep their slots until the next call. Null where some are not there yet;
    /// they are loaded before all others. `wait`: reads them now, and fails where that cannot be.
    virtual std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) = 0;

    /// Of paged bricks, for reports.
    struct Counts {
        uint64_t slots = 0;     ///< bricks that the atlas holds
        uint64_t resident = 0;  ///< that are there
        uint64_t uploads = 0;
        uint64_t evictions = 0;
        uint64_t leaves = 0;                           ///< of the tree
        uint64_t reached = 0;                          ///< of those, by rays
        uint64_t host_bytes = 0, peak_host_bytes = 0;  ///< of bricks kept on the host
        BrickStore::Counts store;
    };
    /// Null where nothing is paged.
    virtual std::optional<Counts> counts() const = 0;

protected:
    DeviceVolume(VolumeInfo info, const IntensityWindow& window) : info_(std::move(info)), window_(window) {}

private:
    VolumeInfo info_;
    IntensityWindow window_;
};

}  // namespace shvr
