#include "engine/bricks/painted_table.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace shvr {

namespace {

constexpr size_t MIN_ENTRIES = 16;
/// Limit of cuckoo insertion: if a brick's place is taken, the occupant moves to its own other place, and so on. If
/// half of the entries are free, an insertion rarely moves more than a dozen bricks.
constexpr int MAX_MOVES = 500;

/// Inserts `brick` into `entries`, moving other bricks if needed. Returns false if that takes over MAX_MOVES moves.
bool insert(std::vector<PaintedBrick>& entries, PaintedBrick brick)
{
    const uint32_t last = uint32_t(entries.size() - 1);
    uint32_t at = gpu::mask_places(brick.brick).x & last;
    for (int moves = 0; moves < MAX_MOVES; ++moves) {
        std::swap(entries[at], brick);
        if (brick.slot == gpu::NO_SLOT) return true;
        const glm::uvec2 places = gpu::mask_places(brick.brick) & last;
        at = places.x == at ? places.y : places.x;
    }
    return false;
}

}  // namespace

std::vector<uint32_t> painted_table(std::span<const PaintedBrick> bricks)
{
    std::vector<PaintedBrick> entries;
    for (size_t count = std::bit_ceil(2 * bricks.size() + MIN_ENTRIES);; count *= 2) {
        entries.assign(count, {});
        if (std::ranges::all_of(bricks, [&](const PaintedBrick& brick) { return insert(entries, brick); })) break;
    }
    std::vector<uint32_t> table{uint32_t(entries.size() - 1)};
    table.reserve(1 + entries.size() * gpu::MASK_ENTRY);
    for (const auto& [brick, slot] : entries) table.insert(table.end(), {brick.x | brick.y << 16, brick.z, slot});
    return table;
}

}  // namespace shvr
