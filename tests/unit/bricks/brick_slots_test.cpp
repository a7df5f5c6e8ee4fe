// Bricks in slots, and evictions: against a model that examines all slots each time. No device.

#include "engine/bricks/brick_slots.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

BrickKey brick(int number)
{
    return {number % 3, {number, 2 * number, 0}};
}

/// The contract of BrickSlots in its simplest form; finds a slot by a search through all of them.
struct Model {
    struct Slot {
        std::optional<int> brick;
        int used = 0;
        bool is_pinned = false;
    };
    std::vector<Slot> slots;
    std::map<int, BrickNeed> needs;
    int now = 1;
    uint64_t evictions = 0;

    explicit Model(size_t count) : slots(count) {}
    BrickNeed need_of(int number) const
    {
        const auto found = needs.find(number);
        return found == needs.end() ? BrickNeed::none : found->second;
    }
    size_t slot_of(int number) const  // 0: none
    {
        for (size_t slot = 1; slot < slots.size(); ++slot)
            if (slots[slot].brick == number) return slot;
        return 0;
    }
    size_t room() const
    {
        return size_t(std::count_if(slots.begin() + 1, slots.end(), [&](const Slot& slot) {
            return !slot.brick || (!slot.is_pinned && need_of(*slot.brick) == BrickNeed::none);
        }));
    }
    bool has_free() const
    {
        return std::any_of(slots.begin() + 1, slots.end(), [](auto& slot) { return !slot.brick; });
    }
    /// The slot to evict for a brick with that need; 0: none.
    size_t victim(BrickNeed need) const
    {
        for (const BrickNeed below : {BrickNeed::picture, BrickNeed::region}) {
            if (below > std::max(need, BrickNeed::picture)) break;
            size_t oldest = 0;
            for (size_t slot = 1; slot < slots.size(); ++slot) {
                const Slot& candidate = slots[slot];
                if (candidate.is_pinned || !(need_of(candidate.brick.value()) < below)) continue;
                if (oldest == 0 || candidate.used < slots[oldest].used) oldest = slot;
            }
            if (oldest > 0) return oldest;
        }
        return 0;
    }
};

/// One history of uses, needs, arrivals and removals; returns the number of evictions.
uint64_t play(uint32_t seed)
{
    std::mt19937 random(seed);
    const auto below = [&](uint32_t end) { return int(random() % end); };
    const auto count = uint32_t(2 + below(12));
    const auto bricks = uint32_t(1 + below(30));
    Model model(count);
    std::map<BrickKey, int, bool (*)(const BrickKey&, const BrickKey&)> numbers(
        [](const BrickKey& a, const BrickKey& b) { return a.brick.x < b.brick.x; });
    for (int number = 0; number < int(bricks); ++number) numbers[brick(number)] = number;
    BrickSlots slots(count, [&](const BrickKey& key) { return model.need_of(numbers.at(key)); });
    for (int step = 0; step < 200; ++step) {
        const int number = below(bricks);
        const BrickKey key = brick(number);
        const size_t slot = model.slot_of(number);
        BrickNeed before = BrickNeed::none;
        switch (below(6)) {
            case 0:
                slots.tick();
                ++model.now;
                break;
            case 1:
                slots.use(key);
                if (slot > 0) model.slots[slot].used = model.now;
                break;
            case 2:
                before = model.need_of(number);
                model.needs[number] = BrickNeed(below(3));
                // A need that rises need not be reported.
                if (model.need_of(number) < before || below(2) == 0) slots.needs_changed();
                break;
            case 3:
                if (slot == 0) break;
                slots.remove(key);
                model.slots[slot] = {};
                ++model.evictions;
                break;
            default: {
                if (slot > 0) break;
                const auto need = BrickNeed(1 + below(2));
                const bool is_pinned = below(10) == 0;
                const bool has_free = model.has_free();
                const size_t victim = has_free ? 0 : model.victim(need);
                const auto placed = slots.place(key, need, is_pinned);
                REQUIRE(placed.has_value() == (has_free || victim > 0));
                if (!placed) break;
                Model::Slot& taken = model.slots.at(placed->slot);
                if (has_free) {
                    REQUIRE(placed->slot > 0);
                    REQUIRE(!taken.brick);
                    REQUIRE(!placed->evicted);
                } else {
                    REQUIRE(placed->slot == victim);
                    REQUIRE(placed->evicted == brick(*taken.brick));
                    ++model.evictions;
                }
                taken = {number, model.now, is_pinned};
            }
        }
        REQUIRE(slots.room() == model.room());
        REQUIRE(slots.evictions() == model.evictions);
        for (int any = 0; any < int(bricks); ++any) REQUIRE(slots.find(brick(any)).value_or(0) == model.slot_of(any));
    }
    return model.evictions;
}

}  // namespace

TEST_CASE("slots: 1000 random histories are those of the simple model")
{
    uint64_t evictions = 0;
    for (uint32_t seed = 0; seed < 1000; ++seed) {
        CAPTURE(seed);
        evictions += play(seed);
    }
    CHECK(evictions > 20000);  // otherwise the tests prove little
}

TEST_CASE("slots: the brick used longest ago goes, needed ones stay, and a region goes before the picture")
{
    std::set<int> seen, worked_on;
    BrickSlots slots(4, [&](const BrickKey& key) {
        if (worked_on.contains(key.brick.x)) return BrickNeed::region;
        return seen.contains(key.brick.x) ? BrickNeed::picture : BrickNeed::none;
    });
    for (const int number : {0, 1, 2}) {
        CHECK(slots.place(brick(number), BrickNeed::picture, false)->slot == uint32_t(number + 1));
        slots.tick();
    }
    slots.use(brick(0));
    CHECK(slots.place(brick(3), BrickNeed::picture, false)->evicted == brick(1));
    seen = {0, 2, 3};
    slots.needs_changed();
    CHECK(slots.room() == 0);
    CHECK(!slots.place(brick(4), BrickNeed::picture, false));
    worked_on = {2, 4};
    slots.needs_changed();
    CHECK(slots.place(brick(4), BrickNeed::region, false)->evicted == brick(0));
    CHECK(!slots.contains(brick(0)));
}

TEST_CASE("slots: what is pinned stays, whoever asks")
{
    BrickSlots slots(3, [](const BrickKey&) { return BrickNeed::none; });
    CHECK(slots.place(brick(0), BrickNeed::region, true).has_value());
    CHECK(slots.place(brick(1), BrickNeed::region, true).has_value());
    CHECK(slots.room() == 0);
    CHECK(!slots.place(brick(2), BrickNeed::region, false));
    slots.remove(brick(0));
    CHECK(slots.place(brick(2), BrickNeed::picture, false)->slot == 1);
}
