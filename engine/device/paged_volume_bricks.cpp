// Paged bricks (paged_volume.h): which bricks are requested, which are needed, and other work's access to level 0.

#include <algorithm>
#include <utility>

#include "engine/device/paged_volume.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Maximum number of bricks re-read while the caller waits, after a change of voxels.
constexpr size_t MAX_RENEWED_NOW = 256;

}  // namespace

bool PagedVolume::leaf_is_reached(const BrickKey& key) const
{
    const std::optional<uint32_t> leaf = leaf_of(key);
    return leaf && is_visited(*leaf);
}

/// `is_before`: the leaf was visited by rays of the previous view but not of the current one.
void PagedVolume::visit(uint32_t leaf, bool is_before)
{
    if (!is_visited(leaf)) {
        visited_.push_back(leaf);
        if (state_of(tree().leaves[leaf].key) == Presence::missing) awaited_.insert(leaf);
    }
    (is_before ? was_reached_ : is_reached_)[leaf] = true;
}

/// Removes unvisited leaves from the list of visited ones.
void PagedVolume::forget_unvisited()
{
    std::erase_if(visited_, [this](uint32_t leaf) { return !is_visited(leaf); });
    std::erase_if(awaited_, [this](uint32_t leaf) { return !is_visited(leaf); });
}

/// Adds the bricks of the same level that are at most `reach` bricks away from `key`, including `key` itself.
void PagedVolume::add_around(const BrickKey& key, int reach, std::unordered_set<BrickKey, BrickKeyHash>& keys) const
{
    const glm::ivec3 counts = brick_counts(size_of_level(info().size, key.level));
    const glm::ivec3 first = glm::max(key.brick - reach, 0), last = glm::min(key.brick + reach, counts - 1);
    for (int z = first.z; z <= last.z; ++z)
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) keys.insert({key.level, {x, y, z}});
}

void PagedVolume::forget_visits()
{
    is_reached_.assign(is_reached_.size(), false);
    was_reached_.assign(was_reached_.size(), false);
    forget_unvisited();
    if (is_ready_) note_all_changed();
    slots_.tick();
    ++reached_revision_;
    is_limited_ = false;
    needs_changed();
}

void PagedVolume::let_rays_wait(bool wait, std::function<bool(const BrickKey&)> is_ready)
{
    if (wait == rays_wait_) return;
    rays_wait_ = wait;
    is_ready_ = std::move(is_ready);
    given_up_.clear();
    note_all_changed();
    forget_visits();
}

bool PagedVolume::limit_visits(const std::vector<int>& reach)
{
    size_t room = slots_.count() - 1;
    for (const auto& [key, slot] : slots_.placed()) room -= slots_.is_pinned(slot) || region_.contains(key);
    const auto takes_room = [&](const BrickKey& key) {
        const std::optional<uint32_t> slot = slots_.find(key);
        return slot ? !slots_.is_pinned(*slot) && !region_.contains(key) : state_of(key) == Presence::missing;
    };
    std::unordered_set<BrickKey, BrickKeyHash> keys;
    bool is_full = false, is_any = false;
    std::ranges::sort(visited_);
    for (const uint32_t leaf : visited_) {
        std::unordered_set<BrickKey, BrickKeyHash> more;
        const BrickKey& key = tree().leaves[leaf].key;
        add_around(key, reach.at(size_t(key.level)), more);
        const auto added = size_t(std::ranges::count_if(
            more, [&](const BrickKey& near) { return !keys.contains(near) && takes_room(near); }));
        is_full = is_full || added > room;
        if (is_full) {
            is_reached_[leaf] = was_reached_[leaf] = false;
            continue;
        }
        is_any = true;
        room -= added;
        keys.merge(more);
    }
    forget_unvisited();
    ++reached_revision_;
    needs_changed();
    return is_any || !is_full;
}

void PagedVolume::want_around(const std::vector<int>& reach)
{
    if (around_reach_ == reach && (reach.empty() || around_revision_ == reached_revision_)) return;
    around_reach_ = reach;
    around_revision_ = reached_revision_;
    std::unordered_set<BrickKey, BrickKeyHash> keys;
    for (const uint32_t leaf : visited_) {
        const BrickKey& key = tree().leaves[leaf].key;
        if (!reach.empty() && state_of(key) != Presence::empty) add_around(key, reach.at(size_t(key.level)), keys);
    }
    if (keys == around_) return;
    around_ = std::move(keys);
    needs_changed();
}

std::vector<DeviceVolume::Place> PagedVolume::places() const
{
    std::vector<Place> places;
    for (const auto& [key, slot] : slots_.placed())
        places.push_back({key, atlas_.packed(slot), known_.range_of(key).value()});
    return places;
}

/// Whether the current picture, or the work around the probe, needs the brick.
BrickNeed PagedVolume::need_of(const BrickKey& key) const
{
    if (region_.contains(key)) return BrickNeed::region;
    return around_.contains(key) || leaf_is_reached(key) ? BrickNeed::picture : BrickNeed::none;
}

void PagedVolume::needs_changed()
{
    wants_are_stale_ = true;
    slots_.needs_changed();
}

bool PagedVolume::place(const BrickKey& key, const BrickTexels& texels, bool for_region)
{
    note(KnownBricks::read(key, texels.range));
    if (slots_.contains(key) || (!for_region && state_of(key) == Presence::empty)) return true;
    const bool is_pinned = std::ranges::find(coarse_, key) != coarse_.end();
    const std::optional<BrickSlots::Placed> placed =
        slots_.place(key, for_region ? BrickNeed::region : BrickNeed::picture, is_pinned);
    if (!placed) return false;
    if (placed->evicted) note({*placed->evicted, BrickEvent::Kind::gone});
    note(KnownBricks::placed(key, atlas_.packed(placed->slot)));
    stage(key, placed->slot, texels);
    return true;
}

void PagedVolume::stage(const BrickKey& key, uint32_t slot, const BrickTexels& texels)
{
    ++places_revision_;
    leap_jobs_.push_back(key);
    note_changed(key);
    atlas_.stage(slot, texels);
}

std::vector<BrickKey> PagedVolume::bricks_of_all_levels(std::span<const VoxelBox> changed) const
{
    std::vector<BrickKey> keys;
    for (int level = 0; level < levels_; ++level)
        for (const BrickKey& key : bricks_that_see(changed, info().size, level)) keys.push_back(key);
    return keys;
}

std::vector<BrickKey> PagedVolume::read_to_renew(std::span<const VoxelBox> changed) const
{
    std::vector<BrickKey> keys = bricks_of_all_levels(changed);
    std::erase_if(keys, [this](const BrickKey& key) { return !slots_.contains(key); });
    if (keys.size() > MAX_RENEWED_NOW)
        std::erase_if(keys, [this](const BrickKey& key) { return !slots_.is_pinned(slots_.find(key).value()); });
    return keys;
}

void PagedVolume::renew(std::span<const VoxelBox> changed)
{
    const std::vector<BrickKey> keys = bricks_of_all_levels(changed), read = read_to_renew(changed);
    const std::unordered_set<BrickKey, BrickKeyHash> now(read.begin(), read.end());
    store_->renew(keys);
    for (const BrickKey& key : keys) {
        note({key, BrickEvent::Kind::unread});
        const std::optional<uint32_t> slot = slots_.find(key);
        if (!slot) continue;
        if (const BrickStore::Texels texels = now.contains(key) ? store_->get(key) : nullptr) {
            note(KnownBricks::read(key, texels->range));
            stage(key, *slot, *texels);
        } else {
            slots_.remove(key);
            note({key, BrickEvent::Kind::gone});
            ++places_revision_;
        }
    }
    atlas_.flush();
    needs_changed();
    rebuild_tree();
}

/// Rebuilds the tree after the source's data has changed, and keeps the record of visited bricks. Waits for the new
/// list, since the caller has to wait for the reloaded bricks anyway.
void PagedVolume::rebuild_tree()
{
    lister_.forget();
    if (!list_) return;
    list_is_outdated_ = true;
    install(lister_.take(list_->sight.view, list_->sight.visibility));
}

/// Adds the bricks that the picture lacks, nearest first. Returns false if the slots cannot hold all of them.
bool PagedVolume::list_wants(std::vector<BrickKey>& keys)
{
    // Some bricks in this sum need no slot, being on the device or arriving. If even the sum fits, all bricks fit.
    const bool is_roomy = keys.size() + awaited_.size() + around_.size() <= slots_.free_count();
    size_t room = is_roomy ? slots_.free_count() : slots_.room();
    room -= std::min(room, keys.size());
    pending_ = 0;
    const auto add = [&](const BrickKey& key) {
        if (pending_ == room) return false;
        ++pending_;
        keys.push_back(key);
        return true;
    };
    for (auto leaf = awaited_.begin(); leaf != awaited_.end();) {
        const BrickKey& key = tree().leaves[*leaf].key;
        if (state_of(key) != Presence::missing) {
            leaf = awaited_.erase(leaf);
            continue;
        }
        if (!add(key)) return false;
        ++leaf;
    }
    for (const BrickKey& key : around_)
        if (state_of(key) == Presence::missing && !leaf_is_reached(key) && !add(key)) return false;
    return true;
}

/// Adds coarser bricks through which the picture refines, before the bricks of `keys` from `first` on: neighbours in
/// the picture are then at most a level apart. Adds only levels for which there is room besides `keys`, coarsest first.
void PagedVolume::add_steps(std::vector<BrickKey>& keys, size_t first) const
{
    auto steps = std::vector<std::vector<BrickKey>>(size_t(levels_));
    std::unordered_set<BrickKey, BrickKeyHash> seen;
    for (size_t i = first; i < keys.size(); ++i)
        for (BrickKey key = parent_of(keys[i]); key.level < levels_ && !slots_.contains(key); key = parent_of(key)) {
            if (!seen.insert(key).second) break;
            if (state_of(key) == Presence::missing) steps[size_t(key.level)].push_back(key);
        }
    const bool is_roomy = keys.size() + seen.size() <= slots_.free_count();
    size_t room = is_roomy ? slots_.free_count() : slots_.room();
    room -= std::min(room, keys.size());
    std::vector<BrickKey> added;
    for (auto level = steps.rbegin(); level != steps.rend() && added.size() + level->size() <= room; ++level)
        added.insert(added.end(), level->begin(), level->end());
    keys.insert(keys.begin() + std::ptrdiff_t(first), added.begin(), added.end());
}

void PagedVolume::update_wants(bool for_steps)
{
    if (!std::exchange(wants_are_stale_, false)) return;
    std::vector<BrickKey> needed;
    for (const BrickKey& key : region_)
        if (!slots_.contains(key) && !store_->failure_of(key)) needed.push_back(key);
    for (const BrickKey& key : coarse_)
        if (!slots_.contains(key) && !store_->failure_of(key)) needed.push_back(key);
    std::vector<BrickKey> keys = needed;
    is_limited_ = !list_wants(keys);
    if (is_limited_ && std::ranges::find(was_reached_, true) != was_reached_.end()) {
        was_reached_.assign(was_reached_.size(), false);
        forget_unvisited();
        ++reached_revision_;
        slots_.needs_changed();
        keys = needed;
        is_limited_ = !list_wants(keys);
    }
    if (for_steps && !is_limited_) add_steps(keys, needed.size());
    store_->want(std::move(keys));
}

std::vector<VoxelBox> PagedVolume::advance(bool wait, const Progress& progress)
{
    update_wants(!wait && !rays_wait_);
    const size_t wanted = std::max<size_t>(pending_, 1);
    std::vector<VoxelBox> changed;
    try {
        do {
            take_bricks(changed);
            tell(progress, 1.0 - double(pending_) / double(wanted));
        } while (wait && store_->wait());
        atlas_.flush();
    } catch (...) {
        needs_changed();  // bricks that were taken but not placed are requested again
        throw;
    }
    return changed;
}

void PagedVolume::take_bricks(std::vector<VoxelBox>& changed)
{
    for (const BrickStore::Finished& finished : store_->take(BrickAtlas::BATCH)) {
        const bool is_wanted = leaf_is_reached(finished.key) || around_.contains(finished.key);
        pending_ -= std::min<size_t>(pending_, is_wanted);
        const bool for_region =
            region_.contains(finished.key) || std::ranges::find(coarse_, finished.key) != coarse_.end();
        if (!finished.texels) {
            note_changed(finished.key);
            ++reached_revision_;
            continue;
        }
        if (!place(finished.key, *finished.texels, for_region)) {
            is_limited_ = is_limited_ || is_wanted || for_region;
            continue;
        }
        changed.push_back(voxels_of(finished.key, info().size));
    }
}

PagedVolume::State PagedVolume::state() const
{
    if (is_limited_) return pending_ > 0 && !wants_are_stale_ ? State::loading : State::limited;
    return pending_ > 0 || wants_are_stale_ ? State::loading : State::complete;
}

size_t PagedVolume::missing() const
{
    if (rays_wait_) return given_up_.size();
    size_t count = 0;
    for (const uint32_t leaf : visited_) count += state_of(tree().leaves[leaf].key) == Presence::failed;
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
        needs_changed();
    }
    return keys;
}

void PagedVolume::prefer(const VoxelBox& voxels)
{
    const RegionBricks region = bricks_around(voxels);
    const size_t bricks = size_t(region.counts.x) * region.counts.y * region.counts.z;
    if (4 * bricks <= slots_.count()) static_cast<void>(set_region(region));
}

std::optional<RegionBricks> PagedVolume::region(const VoxelBox& voxels, bool wait)
{
    RegionBricks region = bricks_around(voxels);
    const size_t bricks = size_t(region.counts.x) * region.counts.y * region.counts.z;
    if (bricks + coarse_.size() >= slots_.count())
        fail("the region around the probe needs ", bricks, " bricks on the device and there is room for ",
             slots_.count() - std::min<size_t>(slots_.count(), coarse_.size() + 1),
             "; expected a smaller radius or a larger budget");
    const std::vector<BrickKey> keys = set_region(region);
    bool all_there = true;
    for (const BrickKey& key : keys) {
        if (!slots_.contains(key) && wait) {
            const BrickStore::Texels texels = store_->get(key);
            if (!texels) throw Error(store_->failure_of(key).value_or(info().name + ": a brick cannot be read"));
            SHVR_CHECK(place(key, *texels, true), "room was counted");
        }
        const std::optional<uint32_t> slot = slots_.find(key);
        if (!slot)
            if (const std::optional<std::string> failure = store_->failure_of(key)) throw Error(*failure);
        all_there = all_there && slot.has_value();
        region.slots.push_back(slot ? atlas_.packed(*slot) : gpu::NO_SLOT);
    }
    atlas_.flush();
    if (!all_there) return std::nullopt;
    for (const BrickKey& key : keys) slots_.use(key);
    return region;
}

/// Records that a brick of any level has gained or lost paint of a level 0 brick below it. Updates the view's entries
/// for the brick and for the neighbours that its paint reaches. With `asks`, returns whether the view now needs other
/// bricks; without `asks`, returns false.
bool PagedVolume::note_painted_in(const BrickKey& key, bool is, bool asks)
{
    std::vector<BrickKey> reached;
    if (list_) reached.push_back(key);
    if (list_ && sight().visibility.params.paint_reach > 0)
        for_each_around(key, [&](const BrickKey& beside) {
            if (!(beside == key) && glm::all(glm::greaterThanEqual(beside.brick, glm::ivec3(0))))
                reached.push_back(beside);
        });
    std::vector<bool> were_shown;
    for (size_t i = 0; asks && i < reached.size(); ++i) were_shown.push_back(known_.may_show(sight(), reached[i]));
    note({key, BrickEvent::Kind::painted, is ? known_.painted_in(key) + 1 : known_.painted_in(key) - 1});
    bool needs_others = false;
    for (size_t i = 0; i < reached.size(); ++i) {
        needs_others = needs_others || (asks && known_.may_show(sight(), reached[i]) != were_shown[i]);
        if (i > 0) note_changed(reached[i]);
        const std::optional<uint32_t> leaf = leaf_of(reached[i]);
        if (leaf && is_visited(*leaf)) awaited_.insert(*leaf);  // a brick that was empty before may now be missing
    }
    return needs_others;
}

void PagedVolume::note_painted(const Mask& mask, std::span<const int64_t> bricks)
{
    const glm::i64vec3 counts = mask.brick_counts();
    bool has_changed = false, needs_others = false;
    for (int64_t index : bricks) {
        BrickKey key{0, glm::ivec3(position_of(index, counts))};
        const bool is = mask.brick(index) != nullptr, was = known_.painted_in(key) > 0;
        has_changed = has_changed || is != was;
        for (; key.level < levels_; key = parent_of(key)) {
            if (is != was) needs_others = note_painted_in(key, is, !needs_others) || needs_others;
            const bool spreads = sight().visibility.params.paint_reach > 0;
            if (!spreads && slots_.contains(key)) leap_jobs_.push_back(key);
            if (spreads)
                for_each_around(key, [&](const BrickKey& around) {
                    if (slots_.contains(around)) leap_jobs_.push_back(around);
                });
        }
    }
    if (!has_changed) return;
    lister_.forget();  // lists of other views
    ++reached_revision_;
    needs_changed();
    if (!needs_others || !list_) return;
    // Paint is visible regardless of the file's densities. The current list is drawn until the new one is ready, so a
    // stroke does not wait for a new list whenever it enters another brick.
    list_is_outdated_ = true;
    static_cast<void>(lister_.get_ready(sight().view, sight().visibility));
}

std::optional<DeviceVolume::Counts> PagedVolume::counts() const
{
    return Counts{.slots = slots_.count() - 1,
                  .resident = slots_.placed_count(),
                  .uploads = atlas_.uploads(),
                  .evictions = slots_.evictions(),
                  .leaves = is_reached_.size(),
                  .reached = visited_.size(),
                  .leaves_looked_up = leaves_looked_up_,
                  .directory_bytes = directory_bytes_,
                  .waits_for_lists = lister_.waits(),
                  .host_bytes = store_->bytes(),
                  .peak_host_bytes = store_->peak_bytes(),
                  .store = store_->counts()};
}

}  // namespace shvr
