#pragma once
// Which brick lies in which of a fixed number of slots, and which gives way to another: of those that nobody needs, the
// one used longest ago. Deterministic plain data: no device, no clock, no files; what is in the slots is their owner's
// affair (engine/device/paged_volume.h).
//
// Finding a slot takes constant time; after needs_changed() the next eviction sorts all slots. One thread.

#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/volume/brick_key.h"

namespace shvr {

/// Who would miss a brick. What is needed for work on a region of level 0 goes before what a picture needs.
enum class BrickNeed : uint8_t { none, picture, region };

class BrickSlots {
public:
    /// Slots 1 ... count - 1; slot 0 is never used. `need` is asked when room has to be made.
    BrickSlots(uint32_t count, std::function<BrickNeed(const BrickKey&)> need);

    uint32_t count() const { return uint32_t(slots_.size()); }
    /// Brick -> slot.
    const std::unordered_map<BrickKey, uint32_t, BrickKeyHash>& placed() const { return placed_; }
    bool contains(const BrickKey& key) const { return placed_.contains(key); }
    std::optional<uint32_t> find(const BrickKey& key) const;
    bool is_pinned(uint32_t slot) const { return slots_[slot].is_pinned; }
    /// Slots that are free, or whose bricks neither picture nor region would miss.
    size_t room() const;
    /// Bricks that have lost their slots.
    uint64_t evictions() const { return evictions_; }

    /// What is used from now on was used later than all before.
    void tick() { ++now_; }
    void use(const BrickKey& key);
    /// `need` may give other answers than before.
    void needs_changed() { evictable_is_stale_ = true; }

    struct Placed {
        uint32_t slot = 0;
        std::optional<BrickKey> evicted;  ///< that was there
    };
    /// A slot for a brick that has none, and that is used now: a free one, or one of a brick that nobody needs. For a
    /// region, bricks that only the picture needs go after those. Nothing where there is no room. Pinned bricks stay
    /// until they are removed.
    std::optional<Placed> place(const BrickKey& key, BrickNeed need, bool is_pinned);
    void remove(const BrickKey& key);

private:
    struct Slot {
        std::optional<BrickKey> key;
        uint64_t used = 0;  ///< now_ of the last use
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
    std::unordered_map<BrickKey, uint32_t, BrickKeyHash> placed_;
    std::vector<uint32_t> free_;
    std::vector<Candidate> evictable_;  ///< that nobody needs; the one to go first last
    bool evictable_is_stale_ = true;
    uint64_t now_ = 1;
    uint64_t evictions_ = 0;
};

}  // namespace shvr
