#pragma once
// A volume whose bricks come and go: any size, any budget.
//
//   view -> PageTree (which bricks, page_tree.h)
//        -> rays note what they come by -> wanted bricks, nearest first
//        -> BrickStore (host budget, loader threads) -> atlas (device budget, least recently needed goes) -> directory
//
// Only bricks that rays come by are wanted: what is outside the view, empty, cut away or hidden behind something opaque is not
// loaded. A missing brick is drawn from the finest coarser one there is; the coarsest levels always are. While the
// view rests a brick that is needed is never given up, so nothing is loaded twice and the picture only gets better.
//
// One thread, the one that owns the executor; nothing here waits for a loader except where it says so.

#include <memory>
#include <optional>
#include <unordered_map>

#include "engine/bricks/brick_slots.h"
#include "engine/bricks/brick_store.h"
#include "engine/bricks/page_tree.h"
#include "engine/device/brick_atlas.h"
#include "engine/device/device_mask.h"
#include "engine/device/device_volume.h"
#include "engine/gpu/executor.h"
#include "engine/passes/brick_leap.h"

namespace shvr {

class PagedVolume final : public DeviceVolume {
public:
    struct Options {
        bool filtered = false;      ///< VolumeBinding
        int threads = 1;            ///< loaders
        uint64_t host_bytes = 0;    ///< of bricks kept on the host
        uint64_t device_bytes = 0;  ///< of the atlas and what goes with it
    };
    /// Reads the coarsest level. Fails where the budget does not hold enough bricks to work with.
    PagedVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                const IntensityWindow& window, const Options& options);

    // ---- What is looked at

    /// From now on this is looked at. Costs nothing where it is the same as before.
    void look(const PageView& view, const Visibility& visibility);
    using TreeRef = std::shared_ptr<const PageTree>;
    const TreeRef& tree() const { return tree_; }
    /// Handles for a graph that draws; brings directory and leaps up to date in it. `binding`: the mask's in that graph,
    /// where anything is painted.
    VolumeBinding import(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& binding,
                         bool feedback);
    /// import() would have work to do before it can draw.
    bool is_stale() const { return directory_is_stale_ || !leap_jobs_.empty(); }

    /// What rays came by in a picture that was drawn with `tree`: the read-back of PageBinding::reached.
    void note_reached(const TreeRef& tree, std::span<const std::byte> bits);
    /// Nothing has been reached yet: the next picture alone says what is needed.
    void forget_reached();
    /// Brings bricks that have come to the device. Returns what may look different now. `wait`: for all that are wanted.
    std::vector<VoxelBox> advance(bool wait = false);

    enum class State {
        complete,  ///< every brick that rays came by is there
        loading,
        limited,  ///< the rest finds no room: more is seen than the budget holds
    };
    State state() const;
    /// Bricks that rays came by and that cannot be read; they are drawn from coarser ones.
    size_t missing() const;
    std::vector<std::string> take_messages() { return store_.take_messages(); }

    // ---- Work on level 0

    VolumeBinding atlas(FrameGraph& graph) const override;
    std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) override;
    int levels() const override { return levels_; }
    glm::uvec3 atlas_slots() const override { return atlas_.slots(); }
    std::vector<Place> places() const override;
    uint64_t places_revision() const override { return places_revision_; }
    /// These bricks are wanted beside what rays come by: light on bricks that are seen comes past them.
    std::vector<BrickKey> reached_bricks() const;
    /// Changes when those do.
    uint64_t reached_revision() const { return reached_revision_; }
    /// Rays came by it.
    bool is_drawn(const BrickKey& key) const { return leaf_is_reached(key); }
    void want_around(std::unordered_set<BrickKey, BrickKeyHash> keys);
    /// Level 0 of `voxels`, where a person is likely to touch or paint next, is loaded before all else, unless that takes
    /// more than a quarter of the room. Until the next call, or that of region().
    void prefer(const VoxelBox& voxels);
    /// The source hands out other voxels of level 0 in these boxes. Bricks that see them, of all levels, are read anew:
    /// at once where they are on the device (but where those are very many, only the coarse ones that are always there;
    /// the others come again like any that are missing), later where they are not.
    void renew(std::span<const VoxelBox> changed);
    /// These bricks of level 0 have been painted, or are no longer.
    void note_painted(const Mask& mask, std::span<const int64_t> bricks);

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
    Counts counts() const;

private:
    enum class LeafState : uint8_t { missing, resident, empty, failed };

    bool is_always_shown(const BrickKey& key) const;
    bool shows(const BrickKey& key) const;
    bool is_painted(const BrickKey& key) const;
    LeafState state_of(const BrickKey& key) const;
    BrickNeed need_of(const BrickKey& key) const;
    bool leaf_is_reached(const BrickKey& key) const;
    void needs_changed();
    bool place(const BrickKey& key, const BrickTexels& texels, bool for_region);
    void stage(const BrickKey& key, uint32_t slot, const BrickTexels& texels);
    void rebuild_tree();
    void update_wants();
    std::vector<BrickKey> set_region(const RegionBricks& region);
    void pin_coarse_levels();
    void fill_directory();
    gpu::BrickLeapJob job_of(const BrickKey& key, uint32_t slot) const;
    int64_t mask_index(const glm::ivec3& brick) const;

    gpu::Memory& memory_;
    std::shared_ptr<const VolumeSource> source_;
    Options options_;
    int levels_;
    BrickAtlas atlas_;
    gpu::Storage cell_leap_, directory_;

    BrickSlots slots_;
    std::unordered_map<BrickKey, BrickTexels::Range, BrickKeyHash> known_ranges_;  ///< of every brick ever read
    std::unordered_map<BrickKey, int64_t, BrickKeyHash> painted_;                  ///< painted bricks of level 0 below

    std::optional<PageView> view_;
    Visibility visibility_;
    TreeRef tree_;
    std::unordered_map<BrickKey, uint32_t, BrickKeyHash> leaf_index_;
    std::vector<bool> is_reached_;   ///< by leaf
    std::vector<uint32_t> entries_;  ///< the directory as it is to be
    bool directory_is_stale_ = true;
    bool wants_are_stale_ = true;
    bool is_limited_ = false;
    size_t pending_ = 0;                                 ///< reached leaves that are wanted and may come
    std::unordered_set<BrickKey, BrickKeyHash> region_;  ///< bricks of the last region
    std::unordered_set<BrickKey, BrickKeyHash> around_;  ///< want_around
    uint64_t places_revision_ = 1, reached_revision_ = 1;
    std::vector<BrickKey> coarse_;  ///< that are to be there always
    std::vector<BrickKey> leap_jobs_;

    BrickStore store_;  ///< last: its loaders end before what they read
};

}  // namespace shvr
