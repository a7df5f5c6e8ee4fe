// Bricks come and go (paged_volume.h): which are wanted, which make room, what work on level 0 finds.

#include <algorithm>
#include <utility>

#include "engine/device/paged_volume.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Bricks that a change of the voxels may read anew while somebody waits.
constexpr size_t MOST_RENEWED_NOW = 256;

}  // namespace

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
    for (const auto& [key, slot] : resident_) places.push_back({key, atlas_.packed(slot), known_ranges_.at(key)});
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

void PagedVolume::stage(const BrickKey& key, uint32_t slot, const BrickTexels& texels)
{
    atlas_.stage(slot, texels);
    ++places_revision_;
    leap_jobs_.push_back(key);
    directory_is_stale_ = true;
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
    atlas_.flush();
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
        for (const BrickStore::Finished& finished : store_.take(BrickAtlas::BATCH)) {
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
    atlas_.flush();
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
        if (there == resident_.end())
            if (const std::optional<std::string> failure = store_.failure_of(key)) throw Error(*failure);
        all_there = all_there && there != resident_.end();
        region.slots.push_back(there == resident_.end() ? gpu::NO_SLOT : atlas_.packed(there->second));
    }
    atlas_.flush();
    if (!all_there) return std::nullopt;
    for (const BrickKey& key : keys) touch(key);
    return region;
}

void PagedVolume::note_painted(const Mask& mask, std::span<const int64_t> bricks)
{
    const glm::i64vec3 counts = mask.brick_counts();
    bool tree_is_stale = false;
    for (int64_t index : bricks) {
        BrickKey key{0, glm::ivec3(position_of(index, counts))};
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
            .uploads = atlas_.uploads(),
            .evictions = evictions_,
            .leaves = is_reached_.size(),
            .reached = uint64_t(std::ranges::count(is_reached_, true)),
            .host_bytes = store_.bytes(),
            .peak_host_bytes = store_.peak_bytes(),
            .store = store_.counts()};
}

}  // namespace shvr
