#pragma once
// Maps each brick of a set to a number: a flat hash table with linear probing. The sets have 10^5 bricks, are rebuilt
// when a camera moves, and are queried for every brick. The standard library's table, which allocates each entry, takes
// four times as long to build and nearly three times to query (engine/device/MEASURED.md). One thread.

#include <optional>
#include <vector>

#include "engine/volume/brick_key.h"

namespace shvr {

class BrickMap {
public:
    size_t size() const { return size_; }
    bool contains(const BrickKey& key) const { return !entries_.empty() && entries_[place_of(key)].key != NONE; }
    std::optional<uint32_t> find(const BrickKey& key) const;

    /// Removes all bricks; reserves capacity for `room` bricks and keeps the existing capacity.
    void clear(size_t room = 0);
    /// Adds a brick, or replaces its number.
    void set(const BrickKey& key, uint32_t number);
    void erase(const BrickKey& key);

private:
    static constexpr uint64_t NONE = 0;
    struct Entry {
        uint64_t key = NONE;  ///< result of `word_of`
        uint32_t number = 0;
    };
    /// Never equal to NONE, since brick coordinates are at most 2^15.
    static uint64_t word_of(const BrickKey& key)
    {
        return uint64_t(key.brick.x) | uint64_t(key.brick.y) << 16 | uint64_t(key.brick.z) << 32 |
               uint64_t(key.level + 1) << 48;
    }
    size_t home_of(uint64_t word) const { return size_t((word * 0x9e3779b97f4a7c15ull) >> shift_); }
    size_t after(size_t place) const { return (place + 1) & (entries_.size() - 1); }
    size_t place_of(const BrickKey& key) const;
    void enlarge(size_t entries);

    std::vector<Entry> entries_;  ///< the size is a power of two; at least half of the entries are free
    size_t size_ = 0;
    int shift_ = 63;  ///< 64 - log2 of the number of entries
};

}  // namespace shvr
