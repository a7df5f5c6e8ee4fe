#include "engine/bricks/brick_map.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace shvr {

std::optional<uint32_t> BrickMap::find(const BrickKey& key) const
{
    if (entries_.empty()) return std::nullopt;
    const Entry& entry = entries_[place_of(key)];
    return entry.key == NONE ? std::nullopt : std::optional(entry.number);
}

/// Index of the brick's entry. If the map lacks the brick: index of the entry where it would be inserted.
size_t BrickMap::place_of(const BrickKey& key) const
{
    const uint64_t word = word_of(key);
    size_t place = home_of(word);
    while (entries_[place].key != word && entries_[place].key != NONE) place = after(place);
    return place;
}

void BrickMap::clear(size_t room)
{
    std::ranges::fill(entries_, Entry());
    size_ = 0;
    if (entries_.size() < 2 * room) enlarge(std::bit_ceil(2 * room));
}

void BrickMap::enlarge(size_t entries)
{
    const std::vector<Entry> before = std::exchange(entries_, std::vector<Entry>(entries));
    shift_ = 64 - std::countr_zero(entries);
    for (const Entry& entry : before) {
        if (entry.key == NONE) continue;
        size_t place = home_of(entry.key);
        while (entries_[place].key != NONE) place = after(place);
        entries_[place] = entry;
    }
}

void BrickMap::set(const BrickKey& key, uint32_t number)
{
    if (2 * (size_ + 1) > entries_.size()) enlarge(std::max<size_t>(16, 2 * entries_.size()));
    Entry& entry = entries_[place_of(key)];
    size_ += entry.key == NONE;
    entry = {word_of(key), number};
}

/// Moves later entries into the gap if searches could no longer find them (Knuth, TAOCP 3, 6.4, algorithm R).
void BrickMap::erase(const BrickKey& key)
{
    if (!contains(key)) return;
    size_t gap = place_of(key);
    for (size_t place = after(gap); entries_[place].key != NONE; place = after(place)) {
        const size_t mask = entries_.size() - 1, home = home_of(entries_[place].key);
        if (((place - home) & mask) < ((place - gap) & mask)) continue;
        entries_[gap] = entries_[place];
        gap = place;
    }
    entries_[gap] = {};
    --size_;
}

}  // namespace shvr
