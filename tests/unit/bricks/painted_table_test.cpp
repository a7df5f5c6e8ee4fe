#include "engine/bricks/painted_table.h"

#include <array>
#include <bit>
#include <random>
#include <set>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

/// What shaders/library/mask.glsl finds.
uint32_t slot_in(std::span<const uint32_t> table, const glm::uvec3& brick)
{
    uint32_t found = gpu::NO_SLOT;
    const glm::uvec2 places = gpu::mask_places(brick);
    for (const uint32_t place : {places.x, places.y}) {
        const std::span entry = table.subspan(1 + size_t(place & table[0]) * gpu::MASK_ENTRY, gpu::MASK_ENTRY);
        if (entry[0] == (brick.x | brick.y << 16) && entry[1] == brick.z) found |= entry[2];
    }
    return found;
}

std::vector<glm::uvec3> block(const glm::uvec3& first, const glm::uvec3& counts)
{
    std::vector<glm::uvec3> bricks;
    for (uint32_t z = 0; z < counts.z; ++z)
        for (uint32_t y = 0; y < counts.y; ++y)
            for (uint32_t x = 0; x < counts.x; ++x) bricks.push_back(first + glm::uvec3(x, y, z));
    return bricks;
}

std::vector<glm::uvec3> scattered(size_t count)
{
    std::mt19937 random(11);  // seed 11
    const auto place = [&] { return uint32_t(random() % 1000); };
    std::set<std::array<uint32_t, 3>> places;
    while (places.size() < count) places.insert({place(), place(), place()});
    std::vector<glm::uvec3> bricks;
    for (const auto& [x, y, z] : places) bricks.emplace_back(x, y, z);
    return bricks;
}

}  // namespace

TEST_CASE("a hashed table has every painted brick, nothing else, and few entries more than it has to")
{
    const std::vector<std::vector<glm::uvec3>> sets = {{},
                                                       {{0, 0, 0}},
                                                       {{65535, 65535, 65535}, {0, 65535, 70000}},
                                                       block({40, 70, 100}, {31, 31, 31}),
                                                       block({0, 0, 300}, {173, 173, 1}),
                                                       block({17, 33, 0}, {1, 1, 1000}),
                                                       scattered(1000),
                                                       scattered(100000)};
    for (const std::vector<glm::uvec3>& bricks : sets) {
        CAPTURE(bricks.size());
        std::vector<PaintedBrick> painted;
        for (const glm::uvec3& brick : bricks) painted.push_back({brick, uint32_t(1 + painted.size())});
        const std::vector<uint32_t> table = painted_table(painted);
        const size_t entries = size_t{table[0]} + 1;
        CHECK(std::has_single_bit(entries));
        CHECK(table.size() == 1 + entries * gpu::MASK_ENTRY);
        CHECK(entries <= 2 * std::bit_ceil(2 * bricks.size() + 16));
        size_t wrong = 0;
        for (const auto& [brick, slot] : painted) wrong += slot_in(table, brick) != slot;
        CHECK(wrong == 0);
        size_t listed = 0;
        for (size_t i = 0; i < entries; ++i) listed += table[1 + i * gpu::MASK_ENTRY + 2] != gpu::NO_SLOT;
        CHECK(listed == bricks.size());
        CHECK(slot_in(table, {1, 2, 3}) == gpu::NO_SLOT);
    }
}
