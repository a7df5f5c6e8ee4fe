#include "engine/bricks/brick_slots.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

BrickSlots::BrickSlots(uint32_t count, std::function<BrickNeed(const BrickKey&)> need)
    : need_(std::move(need)), slots_(count)
{
    for (uint32_t slot = count; slot-- > 1;) free_.push_back(slot);
}

std::vector<std::pair<BrickKey, uint32_t>> BrickSlots::placed() const
{
    std::vector<std::pair<BrickKey, uint32_t>> placed;
    placed.reserve(placed_.size());
    for (uint32_t slot = 1; slot < count(); ++slot)
        if (slots_[slot].key) placed.emplace_back(*slots_[slot].key, slot);
    return placed;
}

size_t BrickSlots::room() const
{
    size_t room = free_.size();
    for (const Slot& slot : slots_) room += slot.key && !slot.is_pinned && need_(*slot.key) == BrickNeed::none;
    return room;
}

void BrickSlots::use(const BrickKey& key)
{
    if (const std::optional<uint32_t> slot = find(key)) slots_[*slot].used = now_;
}

/// Ties go to the lowest slot, so that the same calls always evict the same bricks.
void BrickSlots::list_evictable(BrickNeed below)
{
    evictable_.clear();
    for (uint32_t slot = 1; slot < count(); ++slot)
        if (const Slot& at = slots_[slot]; at.key && !at.is_pinned && need_(*at.key) < below)
            evictable_.push_back({at.used, slot});
    std::ranges::sort(evictable_, std::greater());
}

std::optional<uint32_t> BrickSlots::next_evictable(BrickNeed below)
{
    // Entries may be outdated: a listed brick may now be needed, or may have been used since, which changes its order.
    while (!evictable_is_stale_ && !evictable_.empty()) {
        const Slot& slot = slots_[evictable_.back().slot];
        const bool is_needed = slot.key && need_(*slot.key) != BrickNeed::none;
        if (!is_needed && slot.used == evictable_.back().used) break;
        if (is_needed)
            evictable_.pop_back();
        else
            evictable_is_stale_ = true;
    }
    if (std::exchange(evictable_is_stale_, false)) list_evictable(BrickNeed::picture);
    if (evictable_.empty() && below > BrickNeed::picture) {
        list_evictable(below);
        evictable_is_stale_ = true;  // the list now contains bricks that the picture needs
    }
    if (evictable_.empty()) return std::nullopt;
    const uint32_t slot = evictable_.back().slot;
    evictable_.pop_back();
    return slot;
}

std::optional<BrickSlots::Placed> BrickSlots::place(const BrickKey& key, BrickNeed need, bool is_pinned)
{
    SHVR_CHECK(!contains(key), "a brick is placed once");
    Placed placed;
    if (free_.empty()) {
        const std::optional<uint32_t> slot = next_evictable(need);
        if (!slot) return std::nullopt;
        placed = {*slot, slots_[*slot].key};
        clear(*slot);
    } else {
        placed.slot = free_.back();
        free_.pop_back();
    }
    slots_[placed.slot] = {.key = key, .used = now_, .is_pinned = is_pinned};
    placed_.set(key, placed.slot);
    if (!is_pinned && need_(key) == BrickNeed::none) evictable_is_stale_ = true;
    return placed;
}

void BrickSlots::remove(const BrickKey& key)
{
    const std::optional<uint32_t> slot = find(key);
    SHVR_CHECK(slot.has_value(), "only what has a slot is removed");
    clear(*slot);
    free_.push_back(*slot);
    evictable_is_stale_ = true;
}

void BrickSlots::clear(uint32_t slot)
{
    placed_.erase(*slots_[slot].key);
    slots_[slot] = {};
    ++evictions_;
}

}  // namespace shvr
