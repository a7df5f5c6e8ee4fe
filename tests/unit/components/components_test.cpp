#include "tests/reference/components.h"

#include <bit>
#include <random>
#include <vector>

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::reference;

namespace {

using Words = std::vector<uint32_t>;

BrushRegion box_of(const Size3& size)
{
    BrushRegion region{{{0, 0, 0}, size}, {}};
    region.rows.assign(size_t(size.y * size.z), {0, int(size.x)});
    return region;
}

int64_t count(const Words& words)
{
    int64_t sum = 0;
    for (const uint32_t word : words) sum += std::popcount(word);
    return sum;
}

bool has(const BrushRegion& region, const Words& words, const Size3& voxel)
{
    if (!region.contains(voxel)) return false;
    const Size3 at = voxel - region.box.lower;
    const int64_t word = at.x / 32 + region.words_per_row() * (at.y + region.box.size().y * at.z);
    return (words[size_t(word)] >> at.x % 32 & 1u) != 0;
}

bool is_anywhere(const Size3&)
{
    return true;
}

bool is_nowhere(const Size3&)
{
    return false;
}

bool is_even(const Size3& voxel)
{
    return (voxel.x + voxel.y + voxel.z) % 2 == 0;
}

/// One path through every second row, whose ends lie in opposite corners; sides are odd.
bool is_on_serpentine(const Size3& voxel, const Size3& size)
{
    const bool layer_turns = voxel.z / 2 % 2 == 1;
    if (voxel.z % 2 == 1) return voxel.x == size.x - 1 && voxel.y == (layer_turns ? 0 : size.y - 1);
    const int64_t row = layer_turns ? size.y - 1 - voxel.y : voxel.y;
    if (row % 2 == 0) return true;
    return voxel.x == (row / 2 % 2 == 0 ? size.x - 1 : 0);
}

/// The components by definition, found another way: labels spread from voxel to neighbour until none changes.
std::vector<int> spread_labels(const BrushRegion& region, const OpenVoxel& open, int connectivity)
{
    const Size3 size = region.box.size();
    const auto index = [&](const Size3& at) { return size_t(at.x + size.x * (at.y + size.y * at.z)); };
    std::vector<int> labels(size_t(size.x * size.y * size.z), -1);
    std::vector<Size3> places;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                const Size3 at(x, y, z), voxel = at + region.box.lower;
                if (!region.contains(voxel) || !open(voxel)) continue;
                labels[index(at)] = int(index(at));
                places.push_back(at);
            }
    for (bool changed = true; changed;) {
        changed = false;
        for (const Size3& a : places)
            for (const Size3& b : places) {
                const Size3 away = glm::abs(a - b);
                const bool touches =
                    connectivity == 6 ? away.x + away.y + away.z == 1 : std::max({away.x, away.y, away.z}) == 1;
                if (!touches || labels[index(a)] <= labels[index(b)]) continue;
                labels[index(a)] = labels[index(b)];
                changed = true;
            }
    }
    return labels;
}

}  // namespace

TEST_CASE("fill selects the open voxels of the region and nothing beside it")
{
    const BrushRegion ball = make_region(RegionShape::ball, {20.3, 18.5, 3.0}, 17.5, {1, 1, 3}, {50, 40, 12});
    const Words words = fill_words(ball, is_even);
    CHECK(words.size() == size_t(ball.words_per_row()) * ball.rows.size());
    int64_t expected = 0, wrong = 0;
    for (int64_t z = 0; z < 12; ++z)
        for (int64_t y = 0; y < 40; ++y)
            for (int64_t x = 0; x < 50; ++x) {
                const Size3 voxel(x, y, z);
                expected += ball.contains(voxel) && is_even(voxel);
                wrong += has(ball, words, voxel) != (ball.contains(voxel) && is_even(voxel));
            }
    CHECK(wrong == 0);
    CHECK(count(words) == expected);
    CHECK(count(fill_words(ball, is_nowhere)) == 0);
}

TEST_CASE("bit b of word w of a row is voxel lower + 32 w + b")
{
    BrushRegion region{{{5, 6, 7}, {45, 8, 9}}, {}};
    region.rows.assign(4, {0, 40});
    const Words words = fill_words(region, [](const Size3& v) { return v == Size3(5 + 32 + 3, 7, 8); });
    CHECK(words == Words{0, 0, 0, 0, 0, 0, 0, 8});
}

TEST_CASE("flood: full, empty, one voxel, and seeds that select nothing")
{
    const Size3 size(40, 5, 4);
    const BrushRegion box = box_of(size);
    for (const int connectivity : {6, 26}) {
        CHECK(count(flood_words(box, is_anywhere, {39, 4, 3}, connectivity)) == 40 * 5 * 4);
        CHECK(count(flood_words(box, is_nowhere, {3, 3, 3}, connectivity)) == 0);
        CHECK(count(flood_words(box, is_even, {3, 3, 3}, connectivity)) == 0);
        CHECK(count(flood_words(
                  box, [](const Size3& v) { return v == Size3(3, 3, 3); }, {3, 3, 3}, connectivity)) == 1);
        for (const Size3& outside : {Size3(-1, 0, 0), Size3(40, 0, 0), Size3(0, 5, 0), Size3(0, 0, -1)})
            CHECK(count(flood_words(box, is_anywhere, outside, connectivity)) == 0);
        CHECK(flood_words({}, is_anywhere, {0, 0, 0}, connectivity).empty());
    }
    const BrushRegion ball = make_region(RegionShape::ball, {8, 8, 8}, 5.0, {1, 1, 1}, {16, 16, 16});
    CHECK(count(flood_words(ball, is_anywhere, {3, 3, 3}, 6)) == 0);  // in the ball's box, not in the ball
}

TEST_CASE("flood: a checkerboard is single voxels for 6 neighbours and one component for 26")
{
    const BrushRegion box = box_of({9, 9, 9});
    CHECK(count(flood_words(box, is_even, {4, 4, 4}, 6)) == 1);
    CHECK(count(flood_words(box, is_even, {4, 4, 4}, 26)) == 365);
}

TEST_CASE("flood: voxels that touch over an edge or a corner are connected for 26 only")
{
    const BrushRegion box = box_of({6, 6, 6});
    for (const Size3& other : {Size3(3, 3, 2), Size3(3, 2, 3), Size3(3, 3, 3), Size3(1, 1, 1), Size3(3, 1, 2)}) {
        const auto two = [&](const Size3& v) { return v == Size3(2, 2, 2) || v == other; };
        CHECK(count(flood_words(box, two, {2, 2, 2}, 6)) == 1);
        CHECK(count(flood_words(box, two, {2, 2, 2}, 26)) == 2);
    }
}

TEST_CASE("flood: a serpentine is followed to its end")
{
    const Size3 size(35, 9, 7);
    const BrushRegion box = box_of(size);
    const auto open = [&](const Size3& v) { return is_on_serpentine(v, size); };
    const Words all = fill_words(box, open);
    CHECK(flood_words(box, open, {0, 0, 0}, 6) == all);
    const auto cut = [&](const Size3& v) { return open(v) && v != Size3(17, 4, 2); };
    const int64_t before = count(flood_words(box, cut, {0, 0, 0}, 6));
    const int64_t behind = count(flood_words(box, cut, {17, 4, 4}, 6));
    CHECK(before > 0);
    CHECK(behind > 0);
    CHECK(before + behind == count(all) - 1);
}

TEST_CASE("flood stays inside the region where the structure leaves it and returns")
{
    // A "U" whose bend lies outside the ball: its second arm is not reached.
    const BrushRegion ball = make_region(RegionShape::ball, {10.5, 10.5, 10.5}, 5.0, {1, 1, 1}, {21, 21, 21});
    const auto open = [](const Size3& v) {
        return v.z == 10 && ((v.y == 9 || v.y == 12) || (v.x == 19 && v.y > 9 && v.y < 12));
    };
    const Words words = flood_words(ball, open, {10, 9, 10}, 6);
    CHECK(has(ball, words, {10, 9, 10}));
    CHECK_FALSE(has(ball, words, {10, 12, 10}));
}

TEST_CASE("speckle: what touches the region's edge stays, what does not is selected")
{
    const BrushRegion box = box_of({40, 9, 9});
    for (const int connectivity : {6, 26}) {
        CHECK(count(speckle_words(box, is_anywhere, connectivity)) == 0);
        CHECK(count(speckle_words(box, is_nowhere, connectivity)) == 0);
        CHECK(speckle_words({}, is_anywhere, connectivity).empty());
        const auto speck_and_rod = [](const Size3& v) {
            return v == Size3(33, 4, 4) || v == Size3(34, 4, 4) || (v.y == 2 && v.z == 2 && v.x < 20);
        };
        const Words words = speckle_words(box, speck_and_rod, connectivity);
        CHECK(count(words) == 2);
        CHECK(has(box, words, {33, 4, 4}));
    }
}

TEST_CASE("speckle: the outermost layer of a box is its edge, the next one is not")
{
    const BrushRegion box = box_of({9, 8, 7});
    for (const Size3& inner : {Size3(1, 1, 1), Size3(7, 6, 5)})
        CHECK(count(speckle_words(
                  box, [&](const Size3& v) { return v == inner; }, 6)) == 1);
    for (const Size3& outer : {Size3(0, 3, 3), Size3(8, 3, 3), Size3(3, 0, 3), Size3(3, 7, 3), Size3(3, 3, 0)})
        CHECK(count(speckle_words(
                  box, [&](const Size3& v) { return v == outer; }, 6)) == 0);
}

TEST_CASE("speckle: the volume's border is an edge")
{
    const BrushRegion region = make_region(RegionShape::box, {0.5, 8.5, 8.5}, 5.0, {1, 1, 1}, {16, 16, 16});
    CHECK(count(speckle_words(
              region, [](const Size3& v) { return v == Size3(0, 8, 8); }, 6)) == 0);
    CHECK(count(speckle_words(
              region, [](const Size3& v) { return v == Size3(1, 8, 8); }, 6)) == 1);
}

TEST_CASE("speckle: a diagonal neighbour on the edge counts for 26 only, and makes no edge itself")
{
    const BrushRegion box = box_of({9, 9, 9});
    const auto open = [](const Size3& v) { return v == Size3(1, 1, 4) || v == Size3(0, 0, 4); };
    const Words six = speckle_words(box, open, 6);
    CHECK(count(six) == 1);
    CHECK(has(box, six, {1, 1, 4}));
    CHECK(count(speckle_words(box, open, 26)) == 0);
}

TEST_CASE("random volumes near percolation: flood and speckle agree with labels that spread")
{
    for (uint32_t seed = 0; seed < 40; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const int connectivity = random() % 2 == 0 ? 6 : 26;
        const Size3 size(36, 9, 8);
        const auto shape = random() % 2 == 0 ? RegionShape::ball : RegionShape::box;
        const glm::dvec3 centre(double(random() % 36), double(random() % 9) + 0.5, double(random() % 8));
        const BrushRegion region = make_region(shape, centre, 3.0 + double(random() % 4), {1, 1, 1.5}, size);
        const double share = connectivity == 6 ? 0.3116 : 0.0976;
        std::vector<bool> values;
        for (int64_t i = 0; i < size.x * size.y * size.z; ++i)
            values.push_back(std::uniform_real_distribution<double>()(random) < share);
        const auto open = [&](const Size3& v) { return bool(values[size_t(v.x + size.x * (v.y + size.y * v.z))]); };

        const std::vector<int> labels = spread_labels(region, open, connectivity);
        const Size3 extent = region.box.size();
        const auto label = [&](const Size3& v) {
            const Size3 at = v - region.box.lower;
            return labels[size_t(at.x + extent.x * (at.y + extent.y * at.z))];
        };
        std::vector<bool> touches_edge(labels.size());
        const auto each = [&](const auto& visit) {
            for (int64_t z = 0; z < extent.z; ++z)
                for (int64_t y = 0; y < extent.y; ++y)
                    for (int64_t x = 0; x < extent.x; ++x) visit(region.box.lower + Size3(x, y, z));
        };
        each([&](const Size3& v) {
            if (label(v) < 0) return;
            for (const Size3& step : {Size3(1, 0, 0), Size3(0, 1, 0), Size3(0, 0, 1)})
                if (!region.contains(v + step) || !region.contains(v - step)) touches_edge[size_t(label(v))] = true;
        });
        const Size3 seed_voxel(glm::floor(centre));
        const int wanted = region.contains(seed_voxel) ? label(seed_voxel) : -1;
        const Words flood = flood_words(region, open, seed_voxel, connectivity);
        const Words speckle = speckle_words(region, open, connectivity);
        int64_t wrong = 0;
        each([&](const Size3& v) {
            const int own = label(v);
            wrong += has(region, flood, v) != (own >= 0 && own == wanted);
            wrong += has(region, speckle, v) != (own >= 0 && !touches_edge[size_t(own)]);
        });
        CHECK(wrong == 0);
    }
}
