#pragma once
// A volume of paged bricks: any size, any budget.
//
//   view -> PageTree (which bricks, page_tree.h), and its directory, listed on a thread of their own (page_lister.h)
//        -> rays mark what they visit -> wanted bricks, coarser levels first, nearest first within each
//        -> BrickStore (host budget, loader threads)
//        -> atlas (device budget, least recently used is evicted) -> directory
//
// Only bricks that rays visit are requested: bricks outside the view, empty, cut away or hidden behind something opaque
// are not loaded. A missing brick is drawn from the finest coarser one available; the coarsest levels are always on the
// device. A picture on a screen refines one level at a time, so that neighbours are at most a level apart; where the
// caller waits for a complete picture, or slots are scarce, only the bricks of that picture are loaded. While the view
// rests, needed bricks are never evicted, so nothing is loaded twice and the picture only improves.
//
// The cost of a brick that arrives or is evicted does not depend on how many bricks the view has: its directory entries
// are patched, on the host and on the device.
//
// Used only by the thread that owns the executor. Nothing here waits for a loader unless its comment says so.

#include <memory>
#include <optional>
#include <set>
#include <unordered_map>

#include "engine/bricks/brick_slots.h"
#include "engine/device/brick_atlas.h"
#include "engine/device/device_volume.h"
#include "engine/device/page_lister.h"

namespace shvr {

class PagedVolume final : public DeviceVolume {
public:
    /// Enough slots for any region of 64^3 voxels, the bricks around it, and the coarsest levels.
    static constexpr uint64_t MIN_SLOTS = 64;

    struct Options {
        AtlasCodes codes = AtlasCodes::exact16;
        int threads = 1;            ///< loader threads
        uint64_t host_bytes = 0;    ///< budget of the bricks kept on the host
        uint64_t device_bytes = 0;  ///< budget of the atlas and its tables
        bool in_slices = false;     ///< the constructor does not read the coarsest level; `load_on` loads it in time
                                    ///< slices
        /// Bricks that an earlier volume of the same source keeps on the host. With these, the volume may be used
        /// before it is loaded: what is missing shows nothing until it arrives, as other bricks do.
        std::shared_ptr<BrickStore> host_bricks{};
    };
    /// Reads the coarsest level. Fails if the budget holds too few bricks to work with.
    PagedVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                const IntensityWindow& window, const Options& options);

    bool load_on(double seconds) override;
    double loaded() const override;

    /// Fails if `device_bytes` has too little room for bricks in addition to the volume's coarsest level.
    static void check_room(const gpu::DeviceTraits& traits, const VolumeInfo& info, int levels, AtlasCodes codes,
                           uint64_t device_bytes);

    bool get_ready(const PageView& view, const Visibility& visibility) override;
    int look(const PageView& view, const Visibility& visibility) override;
    void look_by(const Visibility& visibility) override;
    bool has_view() const override { return list_ != nullptr; }
    int finest_level() const override { return list_ ? list_->tree->finest_level : 0; }
    /// prepare() does all preparation, since it depends on the view.
    std::optional<FrameGraph> next_preparation(const Visibility&, const DeviceMask&) override { return std::nullopt; }
    std::optional<FrameGraph> next_refinement(const Visibility&, const DeviceMask&) override { return std::nullopt; }
    bool refinement_is_due() const override { return false; }
    VolumeBinding prepare(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& painted,
                          bool feedback) override;
    bool is_stale() const override { return directory_is_stale_ || !leap_jobs_.empty(); }

    Feedback request_feedback(FrameGraph& graph, const VolumeBinding& volume) const override;
    void take_feedback(const Feedback& feedback, const gpu::FrameResult& result) override;
    void forget_visits() override;
    void let_rays_wait(bool wait, std::function<bool(const BrickKey&)> is_ready = {}) override;
    bool limit_visits(const std::vector<int>& reach) override;
    Presence presence_of(const BrickKey& key) const override { return state_of(key); }
    bool has_rays_waiting() const override { return rays_wait_ && !visited_.empty(); }
    std::vector<VoxelBox> advance(bool wait = false, const Progress& progress = {}) override;
    State state() const override;
    size_t missing() const override;
    std::vector<std::string> take_messages() override { return store_->take_messages(); }
    bool is_drawn(const BrickKey& key) const override { return leaf_is_reached(key); }
    void want_around(const std::vector<int>& reach) override;
    void prefer(const VoxelBox& voxels) override;

    std::vector<BrickKey> read_to_renew(std::span<const VoxelBox> changed) const override;
    /// Reloads the bricks of all levels that depend on the voxels. Bricks on the device are reloaded at once. If there
    /// are too many, only the coarse bricks that always stay on the device are reloaded at once; the others are
    /// requested again like missing bricks. Bricks that are not on the device are reloaded when needed.
    void renew(std::span<const VoxelBox> changed) override;
    void note_painted(const Mask& mask, std::span<const int64_t> bricks) override;

    int levels() const override { return levels_; }
    glm::uvec3 atlas_slots() const override { return atlas_.slots(); }
    std::vector<Place> places() const override;
    uint64_t places_revision() const override { return places_revision_; }
    uint64_t visits_revision() const override { return reached_revision_; }
    VolumeBinding atlas(FrameGraph& graph) override;
    std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) override;
    std::optional<Counts> counts() const override;
    std::shared_ptr<BrickStore> host_bricks() const override { return store_; }

private:
    PageView rounded(PageView view) const;
    void install(std::shared_ptr<PageList> list);
    /// The sight of the current list; an empty sight before the first call of look().
    const PageSight& sight() const { return list_ ? list_->sight : no_sight_; }
    const PageTree& tree() const { return *list_->tree; }
    std::optional<uint32_t> leaf_of(const BrickKey& key) const
    {
        return list_ ? list_->leaves.find(key) : std::nullopt;
    }
    Presence state_of(const BrickKey& key) const;
    void add_around(const BrickKey& key, int reach, std::unordered_set<BrickKey, BrickKeyHash>& keys) const;
    BrickNeed need_of(const BrickKey& key) const;
    bool leaf_is_reached(const BrickKey& key) const;
    bool is_visited(size_t leaf) const { return is_reached_[leaf] || was_reached_[leaf]; }
    void visit(uint32_t leaf, bool is_before);
    void forget_unvisited();
    std::vector<BrickKey> bricks_of_all_levels(std::span<const VoxelBox> changed) const;
    bool list_wants(std::vector<BrickKey>& keys);
    void needs_changed();
    bool place(const BrickKey& key, const BrickTexels& texels, bool for_region);
    void stage(const BrickKey& key, uint32_t slot, const BrickTexels& texels);
    void note_reached(const std::shared_ptr<const PageTree>& drawn, std::span<const std::byte> bits);
    void rebuild_tree();
    bool note_painted_in(const BrickKey& key, bool is, bool asks);
    void add_leaps(FrameGraph& graph, VolumeBinding& volume, const DeviceMask& mask,
                   const std::optional<MaskBinding>& painted);
    Resource upload_directory(FrameGraph& graph);
    std::vector<BufferRegion> changed_regions(std::vector<uint32_t> entries, std::vector<uint32_t>& values) const;
    void add_steps(std::vector<BrickKey>& keys, size_t first) const;
    void update_wants(bool for_steps);
    void take_bricks(std::vector<VoxelBox>& changed);
    std::vector<BrickKey> set_region(const RegionBricks& region);
    void pin_coarse_levels();
    uint32_t entry_of(const BrickKey& leaf) const;
    void set_entry(uint32_t entry, uint32_t value);
    void fill_leaf(uint32_t leaf);
    void fill_below(const BrickKey& key);
    void fill_directory();
    void note(const BrickEvent& change);
    /// Notes a change that has no BrickEvent kind of its own but affects how this brick is drawn.
    void note_changed(const BrickKey& key) { note({.key = key}); }
    void note_all_changed();
    gpu::BrickLeapJob job_of(const BrickKey& key, uint32_t slot) const;
    int64_t mask_index(const glm::ivec3& brick) const;

    gpu::Memory& memory_;
    std::shared_ptr<const VolumeSource> source_;
    Options options_;
    int levels_;
    BrickAtlas atlas_;
    gpu::Storage cell_leap_, directory_;

    BrickSlots slots_;
    KnownBricks known_;  ///< known state of the bricks: slots, ranges of those read, and paint
    PageLister lister_;
    const PageSight no_sight_{};
    std::shared_ptr<PageList> list_;  ///< the current view's list
    bool list_is_outdated_ = false;   ///< paint changed which bricks the view needs, so a new list is being made

    // Indexed by leaf.
    std::vector<bool> is_reached_;  ///< leaves visited by rays since the view last changed
    /// Leaves visited in earlier views. They count as visited while the slots hold their bricks and those of the leaves
    /// visited now. Without this limit, bricks that are no longer visible would be kept when the camera turns.
    std::vector<bool> was_reached_;
    std::vector<uint32_t> visited_;  ///< leaves in either set
    std::set<uint32_t> awaited_;     ///< includes all visited leaves whose bricks are missing; nearest first
    bool rays_wait_ = false;
    std::function<bool(const BrickKey&)> is_ready_;
    /// Bricks that rays have waited for but that cannot be read. Coarser bricks are drawn instead.
    std::unordered_set<BrickKey, BrickKeyHash> given_up_;
    /// Indices of the directory entries (of the current list) that differ from the entries on the device. Not used
    /// while all_entries_changed_ is true.
    std::vector<uint32_t> changed_entries_;
    bool all_entries_changed_ = true;
    bool all_leaves_are_stale_ = true;
    bool directory_is_stale_ = true;  ///< changes may have been noted since the directory was uploaded
    uint64_t leaves_looked_up_ = 0, directory_bytes_ = 0;
    bool wants_are_stale_ = true;
    bool is_limited_ = false;
    size_t pending_ = 0;                                 ///< visited leaves whose bricks are requested and can arrive
    std::unordered_set<BrickKey, BrickKeyHash> region_;  ///< bricks of the last region
    std::unordered_set<BrickKey, BrickKeyHash> around_;  ///< bricks requested by want_around()
    std::vector<int> around_reach_;
    uint64_t around_revision_ = 0;  ///< value of reached_revision_ at which around_ was made
    uint64_t places_revision_ = 1, reached_revision_ = 1;
    std::vector<BrickKey> coarse_;             ///< bricks that are always on the device
    size_t coarsest_ = 0, coarsest_left_ = 0;  ///< number of bricks that `load_on` has to load, and how many remain
    std::vector<BrickKey> leap_jobs_;

    std::shared_ptr<BrickStore> store_;  ///< declared last: loaders stop before the source that they read is destroyed
};

}  // namespace shvr
