#pragma once
// A volume on the device: either resident, with all bricks on the device (resident_volume.h), or paged
// (paged_volume.h). Callers need not know which kind it is; most of these calls do nothing in a resident volume.
//
// For each picture: look(), prepare(), the passes that draw, request_feedback(), later take_feedback(). Between
// pictures: advance(). Used only by the thread that owns the executor.

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

/// Number of bricks that an atlas holds along each axis, at least `slots` in total. Slots fill rows of bricks first.
/// Narrow rows keep a brick's texels close together in memory on devices with linear images.
glm::uvec3 atlas_layout(uint64_t slots, uint32_t brick_texels, uint32_t max_side, bool narrow);
/// Maximum number of slots for atlas_layout().
uint64_t max_atlas_slots(uint32_t brick_texels, uint32_t max_side);

/// An atlas of paged bricks: images of the same size, stacked along z (shaders/library/atlas.glsl).
struct StackedLayout {
    glm::uvec3 slots{0};  ///< slots of one image
    uint32_t images = 1;
    bool by_address = false;  ///< a buffer instead of images
    glm::uvec3 all() const { return slots * glm::uvec3(1, 1, images); }
    uint64_t count() const { return uint64_t{slots.x} * slots.y * slots.z * images; }
};
/// Whether an atlas of this size is a buffer that kernels read by its address.
bool is_by_address(const gpu::DeviceTraits& traits, AtlasCodes codes, uint64_t bytes);
/// A layout of at least this many slots, in a buffer if the device reads those faster, or in as few images as its
/// limits allow; null if none is possible.
std::optional<StackedLayout> stacked_layout(uint64_t slots, AtlasCodes codes, const gpu::DeviceTraits& traits);

/// The packed address of slot `index`. Indices increase along x first.
uint32_t slot_at(uint32_t index, const glm::uvec3& slots);

/// The bricks of `level`, without duplicates, whose texels (with aprons) depend on the level 0 voxels in `boxes`.
std::vector<BrickKey> bricks_that_see(std::span<const VoxelBox> boxes, const Size3& size, int level);

/// The bricks of level 0 that overlap a box of voxels; their slots are not filled in.
RegionBricks bricks_around(const VoxelBox& voxels);

class DeviceVolume {
public:
    /// A brick that has a slot, for work that visits all bricks on the device.
    struct Place {
        BrickKey key;
        uint32_t slot = 0;         ///< packed
        BrickTexels::Range range;  ///< range of its codes
    };

    virtual ~DeviceVolume() = default;
    DeviceVolume(const DeviceVolume&) = delete;
    DeviceVolume& operator=(const DeviceVolume&) = delete;

    const VolumeInfo& info() const { return info_; }
    const IntensityWindow& window() const { return window_; }

    // ---- Loading in time slices, if requested: nothing else may be called before loading is complete

    /// Uploads bricks that have been read, for about `seconds`; never waits for a disk. Returns true once all bricks
    /// are loaded. Fails in the same cases as the constructor that loads at once.
    virtual bool load_on(double seconds) = 0;
    /// The loaded fraction, 0 to 1.
    virtual double loaded() const = 0;

    // ---- The view

    /// Whether look() with these arguments would return without waiting. If it would wait, starts listing the required
    /// bricks in the background; the caller has to ask again later. Fails as look() does.
    virtual bool get_ready(const PageView& view, const Visibility& visibility) = 0;
    /// Sets the view; waits until its bricks are listed. Does nothing if the view is unchanged. Returns finest_level().
    virtual int look(const PageView& view, const Visibility& visibility) = 0;
    /// Sets what is visible without changing the current view.
    virtual void look_by(const Visibility& visibility) = 0;
    /// Whether the bricks that the view needs are known.
    virtual bool has_view() const = 0;
    /// The finest level that the view needs. The sample distance may be up to one voxel of that level.
    virtual int finest_level() const = 0;

    /// Returns a graph with one short step of prepare()'s work that can be done in advance; null if no such step is
    /// left. The graph must be submitted before the next call.
    virtual std::optional<FrameGraph> next_preparation(const Visibility& visibility, const DeviceMask& mask) = 0;
    /// Returns a graph with one step of work that makes later pictures faster without changing them; null if no such
    /// work is left.
    virtual std::optional<FrameGraph> next_refinement(const Visibility& visibility, const DeviceMask& mask) = 0;
    virtual bool refinement_is_due() const = 0;
    /// Adds the passes that update the data read by rays, and returns the handles to draw with. `painted`: handles of
    /// the mask in `graph`. `feedback`: whether rays record the bricks that they visit.
    virtual VolumeBinding prepare(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& painted,
                                  bool feedback) = 0;
    /// Whether prepare() would upload changes made since the last picture.
    virtual bool is_stale() const = 0;

    // ---- Which bricks are needed

    /// A pending read-back of the bricks that the rays of one picture visited.
    class Feedback {
        friend class PagedVolume;
        std::optional<uint32_t> read_back_;
        std::shared_ptr<const PageTree> tree_;  ///< the tree with which the picture was drawn
    };
    /// Adds the read-back, after the draw passes of a graph prepared with feedback.
    virtual Feedback request_feedback(FrameGraph& graph, const VolumeBinding& volume) const = 0;
    /// `result`: the result of that graph.
    virtual void take_feedback(const Feedback& feedback, const gpu::FrameResult& result) = 0;
    /// Discards earlier visits, so that only the next picture determines which bricks are needed.
    virtual void forget_visits() = 0;
    /// Sets whether rays stop and wait at bricks that are not on the device (engine/passes/raycast.h, RaysInWaiting).
    /// If they do, only the bricks that rays wait for count as visited, and earlier visits are discarded. Rays never
    /// wait in a resident volume. `is_ready`: whether a brick on the device can be drawn; null if all can.
    virtual void let_rays_wait(bool wait, std::function<bool(const BrickKey&)> is_ready = {}) = 0;
    /// Discards the farthest visits until the slots suffice for the remaining visited bricks and all bricks within
    /// `reach[level]` bricks of them. Returns false if not even one visited brick and its surroundings fit.
    virtual bool limit_visits(const std::vector<int>& reach) = 0;
    /// Whether any ray is waiting for a brick in the pictures drawn since forget_visits().
    virtual bool has_rays_waiting() const = 0;
    /// Takes loaded bricks into the volume. Returns the voxels whose appearance may have changed. `wait`: waits for all
    /// requested bricks, and reports the fraction that has arrived to `progress`.
    virtual std::vector<VoxelBox> advance(bool wait = false, const Progress& progress = {}) = 0;

    enum class State : uint8_t {
        complete,  ///< every brick that rays visited is on the device
        loading,
        limited,  ///< the budget cannot hold all visited bricks
    };
    virtual State state() const = 0;
    /// Number of visited bricks that cannot be read; coarser bricks are drawn instead.
    virtual size_t missing() const = 0;
    /// Messages about bricks that failed to load since the last call, one sentence each.
    virtual std::vector<std::string> take_messages() = 0;
    enum class Presence : uint8_t {
        there,
        missing,  ///< not on the device yet, but may still be loaded
        empty,    ///< known to show nothing; not loaded
        failed,   ///< it cannot be read
    };
    virtual Presence presence_of(const BrickKey& key) const = 0;
    /// Whether rays are known to have visited the brick.
    virtual bool is_drawn(const BrickKey& key) const = 0;
    /// A number that changes whenever results of is_drawn() or presence_of() may change without a change of places().
    virtual uint64_t visits_revision() const = 0;
    /// Also requests the bricks within `reach[level]` bricks of visited bricks, because ambient light comes from them.
    /// An empty `reach` requests none.
    virtual void want_around(const std::vector<int>& reach) = 0;
    /// Loads level 0 of `voxels` first, because the user is likely to touch or paint there next. Does nothing if these
    /// bricks take more than a quarter of the slots. Remains in effect until the next call of prefer() or region().
    virtual void prefer(const VoxelBox& voxels) = 0;

    // ---- Changes

    /// The bricks that renew() would read, for callers that must not wait for their voxels.
    virtual std::vector<BrickKey> read_to_renew(std::span<const VoxelBox> changed) const = 0;
    /// Reports that the source's level 0 voxels in these boxes have changed; updates everything that depends on them.
    /// Frames submitted later show the change. Fails if voxels cannot be read.
    virtual void renew(std::span<const VoxelBox> changed) = 0;
    /// Reports that the mask changed in these bricks of level 0: they became painted or unpainted.
    virtual void note_painted(const Mask& mask, std::span<const int64_t> bricks) = 0;

    // ---- Work on level 0, and on all bricks on the device

    virtual int levels() const = 0;
    /// Slots of the atlas along each axis.
    virtual glm::uvec3 atlas_slots() const = 0;
    /// All bricks on the device, and a revision number that changes whenever this list changes.
    virtual std::vector<Place> places() const = 0;
    virtual uint64_t places_revision() const = 0;
    /// The volume's handles for kernels that work on a region of level 0.
    virtual VolumeBinding atlas(FrameGraph& graph) = 0;
    /// The bricks that overlap a box of voxels; they keep their slots until the next call. Null if some of them are not
    /// on the device yet; these are then loaded first. `wait`: reads missing bricks now, and fails if it cannot.
    virtual std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) = 0;

    /// Counts of paged bricks, for reports.
    struct Counts {
        uint64_t slots = 0;     ///< capacity of the atlas, in bricks
        uint64_t resident = 0;  ///< bricks on the device
        uint64_t uploads = 0;
        uint64_t evictions = 0;
        uint64_t leaves = 0;   ///< leaves of the tree
        uint64_t reached = 0;  ///< leaves that rays visited
        // Work done by the drawing thread itself:
        uint64_t leaves_looked_up = 0;                 ///< leaves whose directory entries were
                                                       ///< determined
        uint64_t directory_bytes = 0;                  ///< directory bytes written
        uint64_t waits_for_lists = 0;                  ///< calls of look() that had to wait until the view's bricks
                                                       ///< were listed
        uint64_t host_bytes = 0, peak_host_bytes = 0;  ///< bytes of bricks kept on the host
        BrickStore::Counts store;
    };
    /// Null for resident volumes.
    virtual std::optional<Counts> counts() const = 0;
    /// The bricks on the host, for another volume of the same source; null for resident volumes.
    virtual std::shared_ptr<BrickStore> host_bricks() const = 0;

protected:
    DeviceVolume(VolumeInfo info, const IntensityWindow& window) : info_(std::move(info)), window_(window) {}

private:
    VolumeInfo info_;
    IntensityWindow window_;
};

}  // namespace shvr
