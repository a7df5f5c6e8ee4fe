#include "engine/annotation/mask.h"

#include <array>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "engine/annotation/mask_preview.h"

using namespace shvr;

namespace {

std::array<int64_t, 256> recount(const Mask& mask)
{
    std::array<int64_t, 256> counts{};
    const Size3 size = mask.size();
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) ++counts[mask.at({x, y, z})];
    return counts;
}

/// The record that gives one voxel `group`.
MaskBrickChange dot(const Mask& mask, const Size3& voxel, uint8_t group)
{
    const Size3 where = voxel / int64_t{32}, in = voxel % int64_t{32};
    const auto at = uint16_t(in.x + 32 * (in.y + 32 * in.z));
    const glm::i64vec3 counts = mask.brick_counts();
    return {.brick = where.x + counts.x * (where.y + counts.y * where.z),
            .runs = {{.first = at, .last = at, .before = mask.at(voxel), .after = group}}};
}

}  // namespace

TEST_CASE("a mask starts unpainted, without a brick")
{
    const Mask mask({40, 33, 32});
    CHECK(mask.brick_counts() == glm::i64vec3(2, 2, 1));
    CHECK(mask.painted_bricks().empty());
    CHECK(mask.brick(0) == nullptr);
    CHECK(mask.at({39, 32, 31}) == 0);
    CHECK(mask.voxels_by_group()[0] == 40 * 33 * 32);
}

TEST_CASE("a record counts the voxels of its runs")
{
    CHECK(MaskBrickChange{}.voxels() == 0);
    CHECK(MaskBrickChange{.brick = 3, .runs = {{5, 5, 0, 1}, {6, 9, 2, 1}}}.voxels() == 5);
    CHECK(MaskBrickChange{.brick = 3, .runs = {{0, 32767, 0, 1}}}.voxels() == 32768);
}

TEST_CASE("a record changes its voxels, and backwards changes them back and frees the brick")
{
    Mask mask({64, 64, 64});
    const MaskBrickChange paint{.brick = 5, .runs = {{10, 12, 0, 3}, {13, 13, 0, 4}, {32767, 32767, 0, 4}}};
    mask.apply(paint, Direction::forwards);
    CHECK(mask.painted_bricks() == std::vector<int64_t>{5});
    CHECK(mask.at({32 + 9, 0, 32}) == 0);
    CHECK(mask.at({32 + 10, 0, 32}) == 3);
    CHECK(mask.at({32 + 12, 0, 32}) == 3);
    CHECK(mask.at({32 + 13, 0, 32}) == 4);
    CHECK(mask.at({63, 31, 63}) == 4);
    CHECK(mask.voxels_by_group() == recount(mask));

    const MaskBrickChange repaint{.brick = 5, .runs = {{11, 12, 3, 4}, {13, 13, 4, 0}}};
    mask.apply(repaint, Direction::forwards);
    CHECK(mask.at({32 + 11, 0, 32}) == 4);
    CHECK(mask.at({32 + 13, 0, 32}) == 0);
    CHECK(mask.voxels_by_group() == recount(mask));

    mask.apply(repaint, Direction::backwards);
    mask.apply(paint, Direction::backwards);
    CHECK(mask.painted_bricks().empty());
    CHECK(mask.voxels_by_group()[0] == 64 * 64 * 64);
}

TEST_CASE("erasing the last voxel of a brick frees it")
{
    Mask mask({64, 32, 32});
    const Size3 voxel(40, 3, 4);
    mask.apply(dot(mask, voxel, 7), Direction::forwards);
    CHECK(mask.brick(1) != nullptr);
    mask.apply(dot(mask, voxel, 0), Direction::forwards);
    CHECK(mask.brick(1) == nullptr);
}

TEST_CASE("a whole brick in one run, also where it is cut by the volume's border along z")
{
    Mask mask({32, 32, 40});
    mask.apply({.brick = 0, .runs = {{0, 32767, 0, 255}}}, Direction::forwards);
    mask.apply({.brick = 1, .runs = {{0, 8 * 1024 - 1, 0, 254}}}, Direction::forwards);
    CHECK(mask.voxels_by_group()[0] == 0);
    CHECK(mask.voxels_by_group()[255] == 32 * 32 * 32);
    CHECK(mask.voxels_by_group()[254] == 32 * 32 * 8);
    CHECK(mask.voxels_by_group() == recount(mask));
}

TEST_CASE("voxels by group equal a recount after random dots")
{
    for (const uint32_t seed : {1u, 2u, 3u}) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        Mask mask({37, 35, 34});
        for (int i = 0; i < 3000; ++i) {
            const Size3 voxel(random() % 37, random() % 35, random() % 34);
            const auto group = uint8_t(random() % 4 * 85);
            if (mask.at(voxel) != group) mask.apply(dot(mask, voxel, group), Direction::forwards);
        }
        CHECK(mask.voxels_by_group() == recount(mask));
    }
}

TEST_CASE("a preview of changes counts what groups gain and lose, as the mask does after them")
{
    std::mt19937 random(7);
    Mask mask({37, 35, 34});
    const auto voxel_at = [](int number) { return Size3(number % 37, number / 37 % 35, number / (37 * 35)); };
    for (int number = 0; number < 3000; ++number)
        if (random() % 2 == 0) mask.apply(dot(mask, voxel_at(number), uint8_t(1 + random() % 4)), Direction::forwards);
    const auto before = mask.voxels_by_group();
    MaskPreview preview(mask);
    CHECK(preview.groups().empty());
    CHECK(preview.voxels() == 0);
    std::array<int64_t, 256> lost{};
    int64_t changed = 0;
    for (int number = 0; number < 3000; number += 3) {
        const uint8_t old = mask.at(voxel_at(number));
        const auto group = uint8_t(random() % 3 * 4);  // 0, 4 or 8: groups 1 to 3 only lose
        if (group == old) continue;
        const MaskBrickChange change = dot(mask, voxel_at(number), group);
        preview.add(change);
        mask.apply(change, Direction::forwards);
        ++lost[old];
        ++changed;
    }
    CHECK(preview.voxels() == changed);
    std::vector<int> groups;
    for (const MaskPreview::Group& row : preview.groups()) {
        groups.push_back(row.group);
        CAPTURE(row.group);
        CHECK(row.before == before[size_t(row.group)]);
        CHECK(row.lost == lost[size_t(row.group)]);
        CHECK(row.after() == mask.voxels_by_group()[size_t(row.group)]);
    }
    CHECK(groups == std::vector<int>{1, 2, 3, 4, 8});
}

TEST_CASE("voxels beyond the 31st and 32nd bit of their index are their own")
{
    const Size3 size(70000, 70, 1000);  // 4.9e9 voxels
    Mask mask(size);
    CHECK(mask.voxels_by_group()[0] == 4'900'000'000);
    std::vector<Size3> voxels{{69999, 69, 999}};
    for (const int bits : {31, 32})
        for (const int64_t by : {-1, 0, 1}) {
            const int64_t index = (int64_t{1} << bits) + by;
            voxels.emplace_back(index % size.x, index / size.x % size.y, index / (size.x * size.y));
        }
    for (size_t i = 0; i < voxels.size(); ++i) mask.apply(dot(mask, voxels[i], uint8_t(i + 1)), Direction::forwards);
    for (size_t i = 0; i < voxels.size(); ++i) CHECK(mask.at(voxels[i]) == i + 1);
    CHECK(mask.voxels_by_group()[0] == 4'900'000'000 - int64_t(voxels.size()));
}
