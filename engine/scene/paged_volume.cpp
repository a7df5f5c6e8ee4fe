#include "engine/scene/paged_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/scene/device_volume.h"

namespace shvr {

namespace {

constexpr size_t TEXELS = size_t{gpu::BRICK_TEXELS} * gpu::BRICK_TEXELS * gpu::BRICK_TEXELS;
constexpr size_t CELLS = size_t{gpu::BRICK_CELLS} * gpu::BRICK_CELLS * gpu::BRICK_CELLS;
constexpr uint64_t SLOT_BYTES = TEXELS * sizeof(uint16_t) + CELLS * (sizeof(uint32_t) + 1);
constexpr size_t BATCH = 32;  // bricks per upload: twice 2.5 MiB of staging
constexpr size_t CODE_BYTES = TEXELS * sizeof(uint16_t), RANGE_BYTES = CELLS * sizeof(BrickTexels::Range);
/// A region of 64^3 voxels anywhere, its surroundings, and the coarsest levels.
constexpr uint64_t FEWEST_SLOTS = 64;
/// Levels of no more bricks than this are always there.
constexpr int64_t COARSE_BRICKS = 64;
/// Bricks that a change of the voxels may read anew while somebody waits.
constexpr size_t MOST_RENEWED_NOW = 256;

int64_t brick_total(const Size3& size, int level)
{
    const glm::i64vec3 counts(brick_counts(size_of_level(size, level)));
    return counts.x * counts.y * counts.z;
}

uint64_t slots_for(const VolumeInfo& info, int levels, uint64_t bytes)
{
    uint64_t useful = 1;
    for (int level = 0; level < levels; ++level)
        useful += uint64_t(std::min<int64_t>(brick_total(info.size, level), int64_t{1} << 40));
    const uint64_t slots = std::min(useful, bytes / SLOT_BYTES);
    if (slots < std::min(useful, FEWEST_SLOTS))
        fail(info.name, ": ", bytes >> 20, " MiB of device memory are left for its bricks; expected at least ",
             (FEWEST_SLOTS * SLOT_BYTES >> 20) + 1);
    return slots;
}

}  // namespace

PagedVolume::PagedVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                         const IntensityWindow& window, const Options& options)
    : DeviceVolume(source->info(), window),
      executor_(executor),
      memory_(memory),
      source_(std::move(source)),
      options_(options),
      levels_(std::min(source_->levels(), int(gpu::PAGE_NODE) - 1)),
      store_(*source_, window, options.host_bytes, options.threads)
{
    const gpu::DeviceTraits& traits = memory.device().traits();
    const uint64_t slots = slots_for(source_->info(), levels_, options.device_bytes);
    atlas_slots_ = atlas_layout(slots, gpu::BRICK_TEXELS, traits.limits.maxImageDimension3D, traits.is_cpu);
    slots_.resize(size_t(atlas_slots_.x) * atlas_slots_.y * atlas_slots_.z);
    const glm::uvec3 codes = atlas_slots_ * gpu::BRICK_TEXELS;
    atlas_ = memory.create("atlas", options.filtered ? image_desc(Format::r16_unorm, codes)
                                                     : image_desc(Format::r32_uint, codes / glm::uvec3(2, 1, 1)));
    cell_ranges_ = memory.create("cell ranges", image_desc(Format::r32_uint, atlas_slots_ * gpu::BRICK_CELLS));
    cell_leap_ = memory.create("cell leap", image_desc(Format::r8_uint, atlas_slots_ * gpu::BRICK_CELLS));
    for (Staging& staging : staging_)
        staging.bytes =
            memory.create("brick staging", buffer_desc(BATCH * (CODE_BYTES + RANGE_BYTES)), gpu::Placement::upload);
    for (uint32_t slot = uint32_t(slots_.size()) - 1; slot > 0; --slot) unused_.push_back(slot);
    pin_coarse_levels();
}

/// The coarsest level now, so that there is something to see at once; the next ones as soon as may be.
void PagedVolume::pin_coarse_levels()
{
    for (int level = levels_ - 1; level >= 0; --level) {
        if (brick_total(info().size, level) > COARSE_BRICKS && level < levels_ - 1) break;
        const glm::ivec3 counts = brick_counts(size_of_level(info().size, level));
        for (int z = 0; z < counts.z; ++z)
            for (int y = 0; y < counts.y; ++y)
                for (int x = 0; x < counts.x; ++x) {
                    // A quarter of the room at most, and the whole of the coarsest level.
                    if (level < levels_ - 1 && coarse_.size() >= slots_.size() / 4) return;
                    coarse_.push_back({level, {x, y, z}});
                }
        if (level < levels_ - 1) continue;
        if (coarse_.size() >= slots_.size() / 2)
            fail(info().name, ": its coarsest level has ", coarse_.size(), " bricks and the device has room for ",
                 slots_.size(), "; expected a coarser level, as `shvr import` makes");
        for (const BrickKey& key : coarse_)
            if (const BrickStore::Texels texels = store_.get(key)) place(key, *texels, true);
        flush_uploads();
    }
}

uint32_t PagedVolume::packed(uint32_t slot) const
{
    return slot_at(slot, atlas_slots_);
}

// ---- What is looked at ----------------------------------------------------------------------------------------------

bool PagedVolume::is_painted(const BrickKey& key) const
{
    return painted_.contains(key);
}

/// Whatever the transfer function says.
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

void PagedVolume::look(const PageView& view, const Visibility& visibility)
{
    const bool is_other_look = !tree_ || !(visibility == visibility_);
    if (!is_other_look && view_ == view) return;
    if (is_other_look) {
        visibility_ = visibility;
        leap_jobs_.clear();
        for (const auto& [key, slot] : resident_) leap_jobs_.push_back(key);
    }
    view_ = view;
    const TreeRef before = tree_;
    const std::vector<bool> reached_before = std::move(is_reached_);
    tree_ = std::make_shared<const PageTree>(
        make_page_tree(info(), levels_, view, [this](const BrickKey& key) { return shows(key); }));
    leaf_index_.clear();
    for (uint32_t leaf = 0; leaf < tree_->leaves.size(); ++leaf) leaf_index_[tree_->leaves[leaf].key] = leaf;
    is_reached_.assign(tree_->leaves.size(), false);
    // What was needed a moment ago is likely to be needed again.
    for (size_t leaf = 0; before && !is_other_look && leaf < reached_before.size(); ++leaf) {
        if (!reached_before[leaf]) continue;
        const auto found = leaf_index_.find(before->leaves[leaf].key);
        if (found != leaf_index_.end()) is_reached_[found->second] = true;
    }
    ++stamp_;
    ++reached_revision_;
    is_limited_ = false;
    directory_is_stale_ = wants_are_stale_ = evictable_is_stale_ = true;
}

PagedVolume::LeafState PagedVolume::state_of(const BrickKey& key) const
{
    if (resident_.contains(key)) return LeafState::resident;
    const auto range = known_ranges_.find(key);
    if (range != known_ranges_.end() && !is_painted(key) && !is_always_shown(key) &&
        !visibility_.shows(range->second.minimum, range->second.maximum))
        return LeafState::empty;
    return store_.failure_of(key) ? LeafState::failed : LeafState::missing;
}

void PagedVolume::fill_directory()
{
    entries_ = tree_->entries;
    std::vector<uint32_t> entry_of_leaf(tree_->leaves.size());
    constexpr uint32_t NOTHING = 1u << gpu::PAGE_DISTANCE_SHIFT;
    for (size_t leaf = 0; leaf < entry_of_leaf.size(); ++leaf) {
        BrickKey key = tree_->leaves[leaf].key;
        entry_of_leaf[leaf] = NOTHING;
        if (state_of(key) == LeafState::empty) continue;
        for (; key.level < levels_; key = parent_of(key)) {
            const auto there = resident_.find(key);
            if (there == resident_.end()) continue;
            entry_of_leaf[leaf] = uint32_t(key.level) << gpu::PAGE_LEVEL_SHIFT | packed(there->second);
            break;
        }
    }
    for (size_t entry = 0; entry < entries_.size(); ++entry)
        if (const uint32_t leaf = tree_->leaf_of_entry[entry]; leaf != PageTree::NO_LEAF)
            entries_[entry] = entry_of_leaf[leaf];
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
            .slot = packed(slot),
            .mask_slot = is_painted(key)};
}

VolumeBinding PagedVolume::atlas(FrameGraph& graph) const
{
    return {.atlas = graph.import("atlas", atlas_.import()), .filtered = options_.filtered};
}

VolumeBinding PagedVolume::import(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& binding,
                                  bool feedback)
{
    SHVR_CHECK(tree_ != nullptr, "nothing is looked at");
    VolumeBinding volume{.atlas = graph.import("atlas", atlas_.import()),
                         .cell_ranges = graph.import("cell ranges", cell_ranges_.import()),
                         .brick_counts = glm::uvec3(brick_counts(info().size)),
                         .filtered = options_.filtered};
    PageBinding pages{.directory = {},
                      .cell_leap = graph.import("cell leap", cell_leap_.import()),
                      .reached = {},
                      .feedback = feedback,
                      .counts = tree_->counts,
                      .cell_shift = uint32_t(tree_->cell_shift),
                      .depth = uint32_t(tree_->depth)};
    volume.pages = pages;
    if (!leap_jobs_.empty()) {
        std::vector<gpu::BrickLeapJob> jobs;
        for (const BrickKey& key : std::exchange(leap_jobs_, {})) {
            const auto there = resident_.find(key);
            if (there == resident_.end()) continue;
            jobs.push_back(job_of(key, there->second));
            if (key.level == 0 && !mask.empty()) jobs.back().mask_slot = mask.slot_of(mask_index(key.brick));
        }
        brick_leap(graph, volume, visibility_, binding, jobs);
    }
    if (std::exchange(directory_is_stale_, false)) {
        fill_directory();
        // Whole powers of two: views differ, and buffers of a frame are used again where they are of the same size.
        entries_.resize(std::bit_ceil(entries_.size()));
        const uint64_t bytes = entries_.size() * sizeof(uint32_t);
        if (!directory_ || directory_.desc().bytes < bytes) {
            directory_.reset();
            directory_ = memory_.create("page directory", buffer_desc(bytes));
        }
        volume.pages->directory =
            graph.copy(graph.upload<uint32_t>("page directory entries", entries_),
                       graph.import("page directory", directory_.import()), {{0, 0, bytes}}, "upload page directory");
    } else {
        volume.pages->directory = graph.import("page directory", directory_.import());
    }
    const uint64_t words = feedback ? std::bit_ceil((tree_->entries.size() + 31) / 32) : 1;
    volume.pages->reached =
        graph.fill(graph.create("reached", buffer_desc(words * sizeof(uint32_t))), 0, "clear reached");
    return volume;
}

void PagedVolume::note_reached(const TreeRef& tree, std::span<const std::byte> bits)
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
                const auto found = leaf_index_.find(tree->leaves[leaf].key);
                if (found == leaf_index_.end()) continue;
                leaf = found->second;
            }
            if (is_reached_[leaf]) continue;
            is_reached_[leaf] = true;
            touch(tree_->leaves[leaf].key);
            ++reached_revision_;
            wants_are_stale_ = evictable_is_stale_ = true;
        }
    }
}

void PagedVolume::forget_reached()
{
    is_reached_.assign(is_reached_.size(), false);
    ++stamp_;
    ++reached_revision_;
    is_limited_ = false;
    wants_are_stale_ = evictable_is_stale_ = true;
}

// ---- Bricks come and go ---------------------------------------------------------------------------------------------

bool PagedVolume::leaf_is_reached(const BrickKey& key) const
{
    const auto leaf = leaf_index_.find(key);
    return leaf != leaf_index_.end() && is_reached_[leaf->second];
}

std::vector<BrickKey> PagedVolume::reached_bricks() const
{
    std::vector<BrickKey> keys;
    for (size_t leaf = 0; tree_ && leaf < is_reached_.size(); ++leaf)
        if (is_reached_[leaf] && state_of(tree_->leaves[leaf].key) != LeafState::empty)
            keys.push_back(tree_->leaves[leaf].key);
    return keys;
}

void PagedVolume::want_around(std::unordered_set<BrickKey, BrickKeyHash> keys)
{
    if (keys == around_) return;
    around_ = std::move(keys);
    wants_are_stale_ = evictable_is_stale_ = true;
}

std::vector<DeviceVolume::Place> PagedVolume::places() const
{
    std::vector<Place> places;
    for (const auto& [key, slot] : resident_) places.push_back({key, packed(slot), known_ranges_.at(key)});
    return places;
}

void PagedVolume::touch(const BrickKey& key)
{
    const auto there = resident_.find(key);
    if (there != resident_.end()) slots_[there->second].used = stamp_;
}

/// The picture that is looked at, or the work around the probe, would miss it.
bool PagedVolume::is_needed(const BrickKey& key) const
{
    return region_.contains(key) || around_.contains(key) || leaf_is_reached(key);
}

/// A region of level 0 goes before the picture.
void PagedVolume::list_evictable(bool for_region)
{
    evictable_.clear();
    for (uint32_t slot = 1; slot < slots_.size(); ++slot) {
        const Slot& candidate = slots_[slot];
        if (!candidate.key || candidate.pinned) continue;
        if (for_region ? !region_.contains(*candidate.key) : !is_needed(*candidate.key)) evictable_.push_back(slot);
    }
    std::ranges::sort(evictable_, std::greater(), [this](uint32_t slot) { return slots_[slot].used; });
    evictable_is_stale_ = for_region;
}

std::optional<uint32_t> PagedVolume::free_slot(bool for_region)
{
    if (unused_.empty()) {
        if (evictable_is_stale_) list_evictable(false);
        if (evictable_.empty() && for_region) list_evictable(true);
        if (evictable_.empty()) return std::nullopt;
        const uint32_t slot = evictable_.back();
        evictable_.pop_back();
        give_up(slot);
        return slot;
    }
    const uint32_t slot = unused_.back();
    unused_.pop_back();
    return slot;
}

bool PagedVolume::place(const BrickKey& key, const BrickTexels& texels, bool for_region)
{
    known_ranges_[key] = texels.range;
    if (resident_.contains(key)) return true;
    if (!for_region && state_of(key) == LeafState::empty) {
        directory_is_stale_ = true;
        return true;
    }
    const std::optional<uint32_t> slot = free_slot(for_region);
    if (!slot) return false;
    slots_[*slot] = {.key = key, .used = stamp_, .pinned = std::ranges::find(coarse_, key) != coarse_.end()};
    resident_[key] = *slot;
    stage(key, *slot, texels);
    return true;
}

/// Sends a brick to its slot with the next upload.
void PagedVolume::stage(const BrickKey& key, uint32_t slot, const BrickTexels& texels)
{
    ++places_revision_;
    Staging& staging = staging_[filling_];
    if (staging.copy) static_cast<void>(staging.copy.finish());
    std::byte* bytes = staging.bytes.mapped().data();
    std::memcpy(bytes + uploads_.size() * CODE_BYTES, texels.codes.data(), CODE_BYTES);
    std::memcpy(bytes + BATCH * CODE_BYTES + uploads_.size() * RANGE_BYTES, texels.cell_ranges.data(), RANGE_BYTES);
    uploads_.push_back(slot);
    leap_jobs_.push_back(key);
    directory_is_stale_ = true;
    if (uploads_.size() == BATCH) flush_uploads();
}

void PagedVolume::give_up(uint32_t slot)
{
    resident_.erase(*slots_[slot].key);
    slots_[slot] = {};
    ++places_revision_;
    ++evictions_;
    directory_is_stale_ = true;
}

void PagedVolume::renew(std::span<const VoxelBox> changed)
{
    std::vector<BrickKey> keys;
    for (int level = 0; level < levels_; ++level)
        for (const BrickKey& key : bricks_that_see(changed, info().size, level)) keys.push_back(key);
    store_.renew(keys);
    const auto there =
        size_t(std::ranges::count_if(keys, [this](const BrickKey& key) { return resident_.contains(key); }));
    for (const BrickKey& key : keys) {
        known_ranges_.erase(key);
        const auto found = resident_.find(key);
        if (found == resident_.end()) continue;
        const uint32_t slot = found->second;
        const bool now = there <= MOST_RENEWED_NOW || slots_[slot].pinned;
        if (const BrickStore::Texels texels = now ? store_.get(key) : nullptr) {
            known_ranges_[key] = texels->range;
            stage(key, slot, *texels);
        } else {
            give_up(slot);
            unused_.push_back(slot);
        }
    }
    flush_uploads();
    wants_are_stale_ = evictable_is_stale_ = directory_is_stale_ = true;
    rebuild_tree();
}

/// What the source tells of bricks, or what is painted, has changed; what was reached stays so.
void PagedVolume::rebuild_tree()
{
    if (!view_) return;
    const PageView view = *std::exchange(view_, std::nullopt);
    look(view, visibility_);
}

void PagedVolume::flush_uploads()
{
    if (uploads_.empty()) return;
    const glm::uvec3 codes_per_texel(options_.filtered ? 1 : 2, 1, 1);
    std::vector<ImageRegion> atlas_regions, cell_regions;
    for (size_t i = 0; i < uploads_.size(); ++i) {
        const glm::uvec3 slot = gpu::unpack_slot(packed(uploads_[i]));
        atlas_regions.push_back({i * CODE_BYTES, gpu::BRICK_TEXELS * slot / codes_per_texel,
                                 glm::uvec3(gpu::BRICK_TEXELS) / codes_per_texel});
        cell_regions.push_back(
            {BATCH * CODE_BYTES + i * RANGE_BYTES, gpu::BRICK_CELLS * slot, glm::uvec3(gpu::BRICK_CELLS)});
    }
    FrameGraph graph;
    const Resource staged = graph.import("brick staging", staging_[filling_].bytes.import());
    static_cast<void>(
        graph.copy_to_image(staged, graph.import("atlas", atlas_.import()), std::move(atlas_regions), "upload bricks"));
    static_cast<void>(graph.copy_to_image(staged, graph.import("cell ranges", cell_ranges_.import()),
                                          std::move(cell_regions), "upload cell ranges"));
    staging_[filling_].copy = executor_.submit(std::move(graph), {.timestamps = false});
    filling_ = 1 - filling_;
    upload_count_ += uploads_.size();
    uploads_.clear();
}

void PagedVolume::update_wants()
{
    if (!std::exchange(wants_are_stale_, false)) return;
    std::vector<BrickKey> keys;
    for (const BrickKey& key : region_)
        if (!resident_.contains(key) && !store_.failure_of(key)) keys.push_back(key);
    for (const BrickKey& key : coarse_)
        if (!resident_.contains(key) && !store_.failure_of(key)) keys.push_back(key);
    // What has a place, or will have one.
    size_t room = 0;
    for (uint32_t slot = 1; slot < slots_.size(); ++slot) {
        const std::optional<BrickKey>& key = slots_[slot].key;
        room += !key || (!slots_[slot].pinned && !is_needed(*key));
    }
    room -= std::min(room, keys.size());
    pending_ = 0;
    is_limited_ = false;
    for (size_t leaf = 0; tree_ && leaf < is_reached_.size(); ++leaf) {
        if (!is_reached_[leaf] || state_of(tree_->leaves[leaf].key) != LeafState::missing) continue;
        if (pending_ == room) {
            is_limited_ = true;
            break;
        }
        ++pending_;
        keys.push_back(tree_->leaves[leaf].key);
    }
    for (const BrickKey& key : around_) {
        if (state_of(key) != LeafState::missing || leaf_is_reached(key)) continue;
        if (pending_ == room) {
            is_limited_ = true;
            break;
        }
        ++pending_;
        keys.push_back(key);
    }
    store_.want(std::move(keys));
}

std::vector<VoxelBox> PagedVolume::advance(bool wait)
{
    update_wants();
    std::vector<VoxelBox> changed;
    do {
        for (const BrickStore::Finished& finished : store_.take(BATCH)) {
            pending_ -= std::min<size_t>(pending_, leaf_is_reached(finished.key) || around_.contains(finished.key));
            const bool for_region =
                region_.contains(finished.key) || std::ranges::find(coarse_, finished.key) != coarse_.end();
            if (!finished.texels) {
                directory_is_stale_ = true;
                continue;
            }
            if (!place(finished.key, *finished.texels, for_region)) {
                is_limited_ = true;
                continue;
            }
            changed.push_back(voxels_of(finished.key, info().size));
        }
    } while (wait && store_.wait());
    flush_uploads();
    return changed;
}

PagedVolume::State PagedVolume::state() const
{
    if (is_limited_) return pending_ > 0 && !wants_are_stale_ ? State::loading : State::limited;
    return pending_ > 0 || wants_are_stale_ ? State::loading : State::complete;
}

size_t PagedVolume::missing() const
{
    size_t count = 0;
    for (size_t leaf = 0; leaf < is_reached_.size(); ++leaf)
        count += is_reached_[leaf] && state_of(tree_->leaves[leaf].key) == LeafState::failed;
    return count;
}

// ---- Work on level 0 ------------------------------------------------------------------------------------------------

std::vector<BrickKey> PagedVolume::set_region(const RegionBricks& region)
{
    std::vector<BrickKey> keys;
    for (uint32_t z = 0; z < region.counts.z; ++z)
        for (uint32_t y = 0; y < region.counts.y; ++y)
            for (uint32_t x = 0; x < region.counts.x; ++x)
                keys.push_back({0, glm::ivec3(region.begin + glm::uvec3(x, y, z))});
    std::unordered_set<BrickKey, BrickKeyHash> wanted(keys.begin(), keys.end());
    if (region_ != wanted) {
        region_ = std::move(wanted);
        wants_are_stale_ = evictable_is_stale_ = true;
    }
    return keys;
}

void PagedVolume::prefer(const VoxelBox& voxels)
{
    const RegionBricks region = bricks_around(voxels);
    const size_t bricks = size_t(region.counts.x) * region.counts.y * region.counts.z;
    if (4 * bricks <= slots_.size()) static_cast<void>(set_region(region));
}

std::optional<RegionBricks> PagedVolume::region(const VoxelBox& voxels, bool wait)
{
    RegionBricks region = bricks_around(voxels);
    const size_t bricks = size_t(region.counts.x) * region.counts.y * region.counts.z;
    if (bricks + coarse_.size() >= slots_.size())
        fail("the region around the probe needs ", bricks, " bricks on the device and there is room for ",
             slots_.size() - std::min(slots_.size(), coarse_.size() + 1),
             "; expected a smaller radius or a larger budget");
    const std::vector<BrickKey> keys = set_region(region);
    bool all_there = true;
    for (const BrickKey& key : keys) {
        if (!resident_.contains(key) && wait) {
            const BrickStore::Texels texels = store_.get(key);
            if (!texels) throw Error(store_.failure_of(key).value_or(info().name + ": a brick cannot be read"));
            SHVR_CHECK(place(key, *texels, true), "room was counted");
        }
        const auto there = resident_.find(key);
        all_there = all_there && there != resident_.end();
        region.slots.push_back(there == resident_.end() ? gpu::NO_SLOT : packed(there->second));
    }
    flush_uploads();
    if (!all_there) return std::nullopt;
    for (const BrickKey& key : keys) touch(key);
    return region;
}

void PagedVolume::note_painted(const Mask& mask, std::span<const int64_t> bricks)
{
    const glm::i64vec3 counts = mask.brick_counts();
    bool tree_is_stale = false;
    for (int64_t index : bricks) {
        BrickKey key{0, glm::ivec3(index % counts.x, index / counts.x % counts.y, index / (counts.x * counts.y))};
        const bool is = mask.brick(index) != nullptr, was = painted_.contains(key);
        for (; key.level < levels_; key = parent_of(key)) {
            if (is != was) {
                tree_is_stale = true;
                if ((painted_[key] += is ? 1 : -1) == 0) painted_.erase(key);
            }
            if (resident_.contains(key)) leap_jobs_.push_back(key);
        }
    }
    if (tree_is_stale) rebuild_tree();  // what is painted is shown, whatever its density
}

PagedVolume::Counts PagedVolume::counts() const
{
    return {.slots = slots_.size() - 1,
            .resident = resident_.size(),
            .uploads = upload_count_,
            .evictions = evictions_,
            .leaves = is_reached_.size(),
            .reached = uint64_t(std::ranges::count(is_reached_, true)),
            .host_bytes = store_.bytes(),
            .peak_host_bytes = store_.peak_bytes(),
            .store = store_.counts()};
}

}  // namespace shvr
