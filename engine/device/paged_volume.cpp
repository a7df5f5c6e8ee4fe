#include "engine/device/paged_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_set>
#include <utility>

namespace shvr {

namespace {

/// Levels with at most this many bricks are always on the device.
constexpr int64_t COARSE_BRICKS = 64;

int64_t brick_total(const Size3& size, int level)
{
    const glm::i64vec3 counts(brick_counts(size_of_level(size, level)));
    return counts.x * counts.y * counts.z;
}

/// For all bricks of all levels, and the empty one.
uint64_t useful_slots(const VolumeInfo& info, int levels)
{
    uint64_t useful = 1;
    for (int level = 0; level < levels; ++level)
        useful += uint64_t(std::min<int64_t>(brick_total(info.size, level), int64_t{1} << 40));
    return useful;
}

/// As many as fit, rounded as atlas_layout rounds.
uint64_t slots_for(const gpu::DeviceTraits& traits, const VolumeInfo& info, int levels, uint64_t bytes)
{
    const uint64_t useful = useful_slots(info, levels);
    // Paging is for what does not fit: the atlas is as large as one image of the device can be.
    const uint64_t most = std::min({bytes / BrickAtlas::slot_bytes(), traits.max_volume_bytes / BrickTexels::CODE_BYTES,
                                    max_atlas_slots(gpu::BRICK_TEXELS, traits.limits.maxImageDimension3D)});
    const auto made = [&](uint64_t slots) {
        const glm::u64vec3 layout(
            atlas_layout(slots, gpu::BRICK_TEXELS, traits.limits.maxImageDimension3D, traits.is_cpu));
        return layout.x * layout.y * layout.z;
    };
    uint64_t slots = std::min(useful, most);
    while (slots > std::min(PagedVolume::MIN_SLOTS, most) && made(slots) > most) --slots;
    if (slots < std::min(useful, PagedVolume::MIN_SLOTS))
        fail(info.name, ": ", gpu::mebibytes(bytes), " of device memory are left for its bricks; expected at least ",
             gpu::mebibytes(PagedVolume::MIN_SLOTS * BrickAtlas::slot_bytes()), ", as a larger --budget-device gives");
    return slots;
}

int kept_levels(int levels)
{
    return std::min(levels, int(gpu::PAGE_MISSING));
}

/// Half of the room is for finer bricks, unless there is room for all that there are.
void check_coarsest(const VolumeInfo& info, int levels, uint64_t slots)
{
    const int64_t bricks = brick_total(info.size, levels - 1);
    if (slots < useful_slots(info, levels) && bricks >= int64_t(slots / 2))
        fail(info.name, ": its coarsest level has ", bricks, " bricks and the device has room for ", slots,
             "; expected a coarser level, as `shvr import` makes, or --budget-device ",
             (4 * uint64_t(bricks) * BrickAtlas::slot_bytes() >> 20) + 1);
}

}  // namespace

void PagedVolume::check_room(const gpu::DeviceTraits& traits, const VolumeInfo& info, int levels, uint64_t device_bytes)
{
    levels = kept_levels(levels);
    check_coarsest(info, levels, slots_for(traits, info, levels, device_bytes));
}

PagedVolume::PagedVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                         const IntensityWindow& window, const Options& options)
    : DeviceVolume(source->info(), window),
      memory_(memory),
      source_(std::move(source)),
      options_(options),
      levels_(kept_levels(source_->levels())),
      atlas_(executor, memory, slots_for(memory.device().traits(), source_->info(), levels_, options.device_bytes),
             options.filtered),
      slots_(atlas_.slot_count(), [this](const BrickKey& key) { return need_of(key); }),
      store_(*source_, window, options.host_bytes, options.threads)
{
    cell_leap_ = memory.create("cell leap", image_desc(Format::r8_uint, atlas_.slots() * gpu::BRICK_CELLS),
                               gpu::Placement::device, "the volume");
    pin_coarse_levels();
}

/// Loads the coarsest level now, or begins to, so that there is something to show at once, and requests the next ones.
void PagedVolume::pin_coarse_levels()
{
    check_coarsest(info(), levels_, slots_.count());
    for (int level = levels_ - 1; level >= 0; --level) {
        if (brick_total(info().size, level) > COARSE_BRICKS && level < levels_ - 1) break;
        const glm::ivec3 counts = brick_counts(size_of_level(info().size, level));
        for (int z = 0; z < counts.z; ++z)
            for (int y = 0; y < counts.y; ++y)
                for (int x = 0; x < counts.x; ++x) {
                    // At most a quarter of the room, but always the whole coarsest level.
                    if (level < levels_ - 1 && coarse_.size() >= slots_.count() / 4) return;
                    coarse_.push_back({level, {x, y, z}});
                }
        if (level < levels_ - 1) continue;
        if (options_.in_slices) {
            coarsest_ = coarsest_left_ = coarse_.size();
            store_.want(coarse_);
            continue;
        }
        for (const BrickKey& key : coarse_)
            if (const BrickStore::Texels texels = store_.get(key)) place(key, *texels, true);
        atlas_.flush();
    }
}

bool PagedVolume::load_on(double /*seconds*/)
{
    if (coarsest_left_ == 0) return true;
    const std::vector<BrickStore::Finished> finished = store_.take(BrickAtlas::BATCH);
    for (const BrickStore::Finished& brick : finished) {
        if (brick.texels) place(brick.key, *brick.texels, true);
        --coarsest_left_;
    }
    if (!finished.empty()) atlas_.flush();
    return coarsest_left_ == 0;
}

double PagedVolume::loaded() const
{
    return coarsest_ == 0 ? 1.0 : 1.0 - double(coarsest_left_) / double(coarsest_);
}

// ---- The view -------------------------------------------------------------------------------------------------------

bool PagedVolume::is_painted(const BrickKey& key) const
{
    if (visibility_.params.paint_reach == 0) return painted_.contains(key);
    bool is = false;
    if (!painted_.empty()) for_each_around(key, [&](const BrickKey& around) { is = is || painted_.contains(around); });
    return is;
}

/// Whether the brick is shown whatever the transfer function hides.
bool PagedVolume::is_always_shown(const BrickKey& key) const
{
    if (!view_) return false;
    if (view_->shows_all || !view_->shown) return view_->shows_all;
    const VoxelBox voxels = voxels_of(key, info().size);
    return glm::all(glm::lessThan(voxels.lower, view_->shown->upper)) &&
           glm::all(glm::lessThan(view_->shown->lower, voxels.upper));
}

bool PagedVolume::shows(const BrickKey& key) const
{
    if (is_painted(key) || is_always_shown(key)) return true;
    const std::optional<ValueRange> range = source_->brick_range(key.level, Size3(key.brick));
    if (!range) return true;
    return range->lower <= range->upper &&
           visibility_.shows(window().code_of(range->lower), window().code_of(range->upper));
}

int PagedVolume::look(const PageView& view, const Visibility& visibility)
{
    check_camera(view.camera);
    const bool is_other_look = !tree_ || !(visibility == visibility_);
    if (!is_other_look && view_ == view) return finest_level();
    if (is_other_look) {
        visibility_ = visibility;
        leap_jobs_.clear();
        for (const auto& [key, slot] : slots_.placed()) leap_jobs_.push_back(key);
    }
    view_ = view;
    const std::shared_ptr<const PageTree> before = tree_;
    const std::vector<bool> reached_before = std::move(is_reached_), was_reached_before = std::move(was_reached_);
    tree_ = std::make_shared<const PageTree>(
        make_page_tree(info(), levels_, view, [this](const BrickKey& key) { return shows(key); }));
    leaf_index_.clear(tree_->leaves.size());
    for (uint32_t leaf = 0; leaf < tree_->leaves.size(); ++leaf) leaf_index_.set(tree_->leaves[leaf].key, leaf);
    is_reached_.assign(tree_->leaves.size(), false);
    was_reached_.assign(tree_->leaves.size(), false);
    has_visits_ = false;
    // Bricks needed a moment ago are likely to be needed again.
    for (size_t leaf = 0; before && !is_other_look && leaf < reached_before.size(); ++leaf) {
        if (!reached_before[leaf] && !was_reached_before[leaf]) continue;
        if (const std::optional<uint32_t> now = leaf_index_.find(before->leaves[leaf].key))
            was_reached_[*now] = has_visits_ = true;
    }
    slots_.tick();
    ++reached_revision_;
    is_limited_ = false;
    note_all_changed();
    needs_changed();
    return finest_level();
}

void PagedVolume::look_by(const Visibility& visibility)
{
    if (view_) look(PageView(*view_), visibility);
}

DeviceVolume::Presence PagedVolume::state_of(const BrickKey& key) const
{
    if (slots_.contains(key)) return Presence::there;
    const auto range = known_ranges_.find(key);
    if (range != known_ranges_.end() && !is_painted(key) && !is_always_shown(key) &&
        !visibility_.shows(range->second.minimum, range->second.maximum))
        return Presence::empty;
    return store_.failure_of(key) ? Presence::failed : Presence::missing;
}

/// What the directory shows in the place of a leaf: its brick, the finest one above it that is there, or nothing.
uint32_t PagedVolume::entry_of(const BrickKey& leaf) const
{
    const Presence state = state_of(leaf);
    if (state == Presence::empty) return 1u << gpu::PAGE_DISTANCE_SHIFT;
    const bool is_awaited = state == Presence::missing || (state == Presence::failed && !given_up_.contains(leaf)) ||
                            (state == Presence::there && is_ready_ && !is_ready_(leaf));
    if (rays_wait_ && is_awaited) return gpu::PAGE_MISSING << gpu::PAGE_LEVEL_SHIFT;
    for (BrickKey key = leaf; key.level < levels_; key = parent_of(key))
        if (const std::optional<uint32_t> slot = slots_.find(key))
            return uint32_t(key.level) << gpu::PAGE_LEVEL_SHIFT | atlas_.packed(*slot);
    return 1u << gpu::PAGE_DISTANCE_SHIFT;
}

void PagedVolume::fill_directory()
{
    const auto fill = [&](uint32_t leaf) {
        const uint32_t entry = entry_of(tree_->leaves[leaf].key);
        for (uint32_t i = tree_->begin_of_leaf[leaf]; i < tree_->begin_of_leaf[leaf + 1]; ++i)
            entries_[tree_->entries_of_leaves[i]] = entry;
        ++leaves_looked_up_;
    };
    if (std::exchange(all_leaves_are_stale_, false)) {
        entries_ = tree_->entries;
        // Powers of two: views differ, and a frame's buffers are reused if their sizes match.
        entries_.resize(std::bit_ceil(entries_.size()));
        for (uint32_t leaf = 0; leaf < tree_->leaves.size(); ++leaf) fill(leaf);
    } else {
        for (const uint32_t leaf : stale_leaves_) fill(leaf);
    }
    stale_leaves_.clear();
}

void PagedVolume::note_all_changed()
{
    directory_is_stale_ = all_leaves_are_stale_ = true;
}

/// The brick has arrived, has gone, or is known to be empty or unreadable.
void PagedVolume::note_changed(const BrickKey& key)
{
    directory_is_stale_ = true;
    if (all_leaves_are_stale_) return;
    if (const std::optional<uint32_t> leaf = leaf_index_.find(key))
        stale_leaves_.push_back(*leaf);
    else if (key.level > finest_level())  // it may stand in for leaves below it
        all_leaves_are_stale_ = true;
    // What waits for a brick's light waits for its neighbours as well.
    if (is_ready_) all_leaves_are_stale_ = true;
}

int64_t PagedVolume::mask_index(const glm::ivec3& brick) const
{
    const glm::i64vec3 counts(brick_counts(info().size));
    return brick.x + counts.x * (brick.y + counts.y * int64_t{brick.z});
}

gpu::BrickLeapJob PagedVolume::job_of(const BrickKey& key, uint32_t slot) const
{
    return {.brick = glm::uvec3(key.brick),
            .level = uint32_t(key.level),
            .slot = atlas_.packed(slot),
            .mask_slot = is_painted(key)};
}

VolumeBinding PagedVolume::atlas(FrameGraph& graph)
{
    atlas_.flush();
    return {.atlas = atlas_.import_codes(graph), .filtered = options_.filtered};
}

VolumeBinding PagedVolume::prepare(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& painted,
                                   bool feedback)
{
    SHVR_CHECK(tree_ != nullptr, "nothing is looked at");
    atlas_.flush();
    VolumeBinding volume{.atlas = atlas_.import_codes(graph),
                         .cell_ranges = atlas_.import_cell_ranges(graph),
                         .brick_counts = glm::uvec3(brick_counts(info().size)),
                         .filtered = options_.filtered};
    volume.pages = PageBinding{.directory = {},
                               .cell_leap = graph.import("cell leap", cell_leap_.import()),
                               .reached = {},
                               .feedback = feedback,
                               .counts = tree_->counts,
                               .cell_shift = uint32_t(tree_->cell_shift),
                               .depth = uint32_t(tree_->depth)};
    add_leaps(graph, volume, mask, painted);
    volume.pages->directory = upload_directory(graph);
    const uint64_t words = feedback ? std::bit_ceil((tree_->entries.size() + 31) / 32) : 1;
    volume.pages->reached =
        graph.fill(graph.create("reached", buffer_desc(words * sizeof(uint32_t))), 0, "clear reached");
    return volume;
}

/// Computes leaps of bricks that have arrived, or whose look has changed.
void PagedVolume::add_leaps(FrameGraph& graph, VolumeBinding& volume, const DeviceMask& mask,
                            const std::optional<MaskBinding>& painted)
{
    if (leap_jobs_.empty()) return;
    std::vector<gpu::BrickLeapJob> jobs;
    const auto keys = std::make_shared<const std::vector<BrickKey>>(std::exchange(leap_jobs_, {}));
    graph.unless_submitted([this, keys] { leap_jobs_.insert(leap_jobs_.end(), keys->begin(), keys->end()); });
    std::unordered_set<BrickKey, BrickKeyHash> done;
    for (const BrickKey& key : *keys) {
        const std::optional<uint32_t> slot = slots_.find(key);
        if (!slot || !done.insert(key).second) continue;
        jobs.push_back(job_of(key, *slot));
        if (key.level == 0 && !mask.empty() && visibility_.params.paint_reach == 0)
            jobs.back().mask_slot = mask.slot_of(mask_index(key.brick));
    }
    brick_leap(graph, volume, visibility_, painted, jobs);
}

Resource PagedVolume::upload_directory(FrameGraph& graph)
{
    if (!std::exchange(directory_is_stale_, false)) return graph.import("page directory", directory_.import());
    graph.unless_submitted([this] { directory_is_stale_ = true; });
    fill_directory();
    const uint64_t bytes = entries_.size() * sizeof(uint32_t);
    if (!directory_ || directory_.desc().bytes < bytes) {
        directory_.reset();
        directory_ = memory_.create("page directory", buffer_desc(bytes), gpu::Placement::device, "the view");
    }
    return graph.copy(graph.upload<uint32_t>("page directory entries", entries_),
                      graph.import("page directory", directory_.import()), {{0, 0, bytes}}, "upload page directory");
}

DeviceVolume::Feedback PagedVolume::request_feedback(FrameGraph& graph, const VolumeBinding& volume) const
{
    Feedback feedback;
    feedback.read_back_ = graph.read_back(volume.pages->reached, "what rays came by");
    feedback.tree_ = tree_;
    return feedback;
}

void PagedVolume::take_feedback(const Feedback& feedback, const gpu::FrameResult& result)
{
    if (feedback.read_back_) note_reached(feedback.tree_, result.read_backs[*feedback.read_back_]);
}

/// `bits`: PageBinding::reached of a picture drawn with `tree`.
void PagedVolume::note_reached(const std::shared_ptr<const PageTree>& tree, std::span<const std::byte> bits)
{
    for (size_t word = 0; word < bits.size() / sizeof(uint32_t); ++word) {
        uint32_t set = 0;
        std::memcpy(&set, bits.data() + word * sizeof(uint32_t), sizeof set);
        for (; set != 0; set &= set - 1) {
            const size_t entry = 32 * word + size_t(std::countr_zero(set));
            if (entry >= tree->leaf_of_entry.size()) break;
            uint32_t leaf = tree->leaf_of_entry[entry];
            if (leaf == PageTree::NO_LEAF) continue;
            if (tree != tree_) {  // the view has moved since
                const std::optional<uint32_t> now = leaf_index_.find(tree->leaves[leaf].key);
                if (!now) continue;
                leaf = *now;
            }
            if (is_reached_[leaf]) continue;
            is_reached_[leaf] = has_visits_ = true;
            slots_.use(tree_->leaves[leaf].key);
            if (rays_wait_ && state_of(tree_->leaves[leaf].key) == Presence::failed) {
                given_up_.insert(tree_->leaves[leaf].key);
                note_changed(tree_->leaves[leaf].key);
            }
            ++reached_revision_;
            needs_changed();
        }
    }
}

}  // namespace shvr
