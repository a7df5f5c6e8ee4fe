#pragma once
// Assigns bricks to a fixed number of slots, and chooses which brick to evict: the least recently used brick that is
// not needed. Deterministic plain data: no device, no clock, no files. The owner manages the slots' contents
// (engine/device/paged_volume.h).
//
// Finding a slot takes constant time; after needs_changed() the next eviction sorts all slots. Used by one thread.

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "engine/bricks/brick_map.h"

namespace shvr {

/// Why a brick is needed. Work on a region of level 0 has priority over pictures.
enum class BrickNeed : uint8_t { none, picture, region };

class BrickSlots {
public:
    /// Uses slots 1 ... count - 1; slot 0 stays unused. Calls `need` when a brick has to be evicted.
    BrickSlots(uint32_t count, std::function<BrickNeed(const BrickKey&)> need);

    uint32_t count() const { return uint32_t(slots_.size()); }
    /// Bricks and their slots, sorted by slot.
    std::vector<std::pair<BrickKey, uint32_t>> placed() const;
    size_t placed_count() const { return placed_.size(); }
    bool contains(const BrickKey& key) const { return placed_.contains(key); }
    std::optional<uint32_t> find(const BrickKey& key) const { return placed_.find(key); }
    bool is_pinned(uint32_t slot) const { return slots_[slot].is_pinned; }
    size_t free_count() const { return free_.size(); }
    /// Number of slots that are free or whose bricks are needed by neither a picture nor a region. Calls `need` for all
    /// placed bricks.
    size_t room() const;
    /// Bricks evicted so far.
    uint64_t evictions() const { return evictions_; }

    /// Starts a new time step: later uses count as more recent than earlier ones.
    void tick() { ++now_; }
    void use(const BrickKey& key);
    /// Must be called if `need` may have decreased for any brick. Increases require no call, since they are noticed
    /// when the brick is considered for eviction.
    void needs_changed() { evictable_is_stale_ = true; }

    struct Placed {
        uint32_t slot = 0;
        std::optional<BrickKey> evicted;  ///< the brick that previously occupied the slot
    };
    /// Places a brick that has no slot and marks it as used now. Takes a free slot, or evicts a brick that is not
    /// needed. If `need` is BrickNeed::region, may also evict a brick that only the picture needs. Null if no slot can
    /// be freed. Pinned bricks are never evicted, only removed.
    std::optional<Placed> place(const BrickKey& key, BrickNeed need, bool is_pinned);
    void remove(const BrickKey& key);

private:
    struct Slot {
        std::optional<BrickKey> key;
        uint64_t used = 0;  ///< value of now_ at the last use
        bool is_pinned = false;
    };
    struct Candidate {
        uint64_t used;
        uint32_t slot;
        auto operator<=>(const Candidate&) const = default;
    };
    void list_evictable(BrickNeed below);
    std::optional<uint32_t> next_evictable(BrickNeed below);
    void clear(uint32_t slot);

    std::function<BrickNeed(const BrickKey&)> need_;
    std::vector<Slot> slots_;
    BrickMap placed_;
    std::vector<uint32_t> free_;
    std::vector<Candidate> evictable_;  ///< bricks that are not needed, sorted; the last one is evicted first
    bool evictable_is_stale_ = true;
    uint64_t now_ = 1;
    uint64_t evictions_ = 0;
};

}  // namespace shvr
