#include "engine/annotation/region.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "engine/annotation/painting.h"
#include "engine/annotation/work/history.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr glm::dvec3 SPACINGS[] = {
    {1, 1, 1}, {1, 1, 20}, {0.957, 0.957, 1.5}, {1.5, 0.957, 0.957}, {0.957, 0.957, 0.957}};
constexpr double INFINITE = std::numeric_limits<double>::infinity();

template <class Visit>
void for_each_voxel(const Size3& size, const Visit& visit)
{
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) visit(Size3(x, y, z));
}

/// The definition of region.h.
bool belongs(RegionShape shape, const Size3& voxel, const glm::dvec3& centre, double radius, const glm::dvec3& spacing)
{
    const glm::dvec3 away = (glm::dvec3(voxel) + 0.5 - centre) * spacing;
    const glm::dvec3 squares = away * away;
    const double limit = (radius * spacing.x) * (radius * spacing.x);
    if (shape == RegionShape::ball) return squares.x + squares.y + squares.z <= limit;
    return squares.x <= limit && squares.y <= limit && squares.z <= limit;
}

/// Voxels for which region and definition disagree.
int64_t disagreements(RegionShape shape, const glm::dvec3& centre, double radius, const glm::dvec3& spacing,
                      const Size3& size)
{
    const BrushRegion region = make_region(shape, centre, radius, spacing, size);
    int64_t wrong = 0, expected = 0, found = 0;
    for_each_voxel(size, [&](const Size3& voxel) {
        const bool is_in = belongs(shape, voxel, centre, radius, spacing);
        expected += is_in;
        wrong += is_in != region.contains(voxel);
    });
    for (const gpu::RowSpan& span : region.rows) {
        found += span.end - span.begin;
        wrong += span.begin < 0 || span.begin > span.end || span.end > region.box.size().x;
    }
    const Size3 box = region.box.size();
    wrong += int64_t(region.rows.size()) != box.y * box.z;
    return wrong + std::abs(found - expected);
}

/// Between, on and outside the voxels' centres and borders.
double random_coordinate(std::mt19937& random, int64_t size)
{
    const double coordinate = std::uniform_real_distribution<double>(-4.0, double(size) + 4.0)(random);
    switch (random() % 3) {
        case 0: return std::floor(coordinate);
        case 1: return std::floor(coordinate) + 0.5;
        default: return coordinate;
    }
}

glm::dvec3 random_position(std::mt19937& random, const Size3& size)
{
    return {random_coordinate(random, size.x), random_coordinate(random, size.y), random_coordinate(random, size.z)};
}

struct Sample {
    BrushRegion region;
    std::vector<uint32_t> words;
};

/// A region with random bits everywhere, even where it has no voxels.
Sample random_sample(std::mt19937& random, const Size3& size)
{
    const auto shape = random() % 2 == 0 ? RegionShape::ball : RegionShape::box;
    const double radius = std::uniform_real_distribution<double>(0.5, 20.0)(random);
    Sample sample{make_region(shape, random_position(random, size), radius, SPACINGS[random() % 4], size), {}};
    sample.words.resize(size_t(sample.region.words_per_row()) * sample.region.rows.size());
    const bool is_full = random() % 4 == 0;
    for (uint32_t& word : sample.words) word = is_full ? ~0u : uint32_t(random());
    return sample;
}

bool has(const Sample& sample, const Size3& voxel)
{
    const VoxelBox& box = sample.region.box;
    if (!sample.region.contains(voxel)) return false;
    const Size3 at = voxel - box.lower;
    const int64_t word = at.x / 32 + sample.region.words_per_row() * (at.y + box.size().y * at.z);
    return (sample.words[size_t(word)] >> at.x % 32 & 1u) != 0;
}

}  // namespace

TEST_CASE("a region's spans are exactly the voxels within the radius")
{
    constexpr Size3 SIZE(41, 37, 23);
    for (const glm::dvec3& spacing : SPACINGS)
        for (const RegionShape shape : {RegionShape::ball, RegionShape::box}) {
            const uint32_t seed = 7;
            std::mt19937 random(seed);
            int64_t wrong = 0;
            for (int i = 0; i < 150; ++i) {
                // Whole and half radii put voxels exactly on the surface.
                const double radius = random() % 2 == 0 ? 0.5 * double(1 + random() % 40)
                                                        : std::uniform_real_distribution<double>(0.01, 20.0)(random);
                wrong += disagreements(shape, random_position(random, SIZE), radius, spacing, SIZE);
            }
            CAPTURE(seed);
            CAPTURE(spacing.x);
            CAPTURE(spacing.z);
            CHECK(wrong == 0);
        }
}

TEST_CASE("a ball of radius 1 at a voxel's centre is the voxel and its six neighbours; its box has 27")
{
    const BrushRegion ball = make_region(RegionShape::ball, {5.5, 6.5, 7.5}, 1.0, {1, 1, 1}, {20, 20, 20});
    CHECK(ball.box == VoxelBox{{4, 5, 6}, {7, 8, 9}});
    int64_t voxels = 0;
    for_each_voxel({20, 20, 20}, [&](const Size3& voxel) { voxels += ball.contains(voxel); });
    CHECK(voxels == 7);
    CHECK(ball.contains({4, 6, 7}));
    CHECK_FALSE(ball.contains({4, 5, 7}));

    const BrushRegion box = make_region(RegionShape::box, {5.5, 6.5, 7.5}, 1.0, {1, 1, 1}, {20, 20, 20});
    CHECK(box.box == ball.box);
    CHECK(box.contains({4, 5, 6}));
}

TEST_CASE("the radius is measured along x: slices twenty times as far apart make a flat region")
{
    const BrushRegion region = make_region(RegionShape::ball, {15.5, 15.5, 15.5}, 10.0, {1, 1, 20}, {32, 32, 32});
    CHECK(region.box == VoxelBox{{5, 5, 15}, {26, 26, 16}});
}

TEST_CASE("a region is cut at the volume's border and empty beyond it")
{
    const BrushRegion corner = make_region(RegionShape::box, {0, 0, 0}, 3.0, {1, 1, 1}, {20, 20, 20});
    CHECK(corner.box == VoxelBox{{0, 0, 0}, {3, 3, 3}});
    const BrushRegion whole = make_region(RegionShape::ball, {10, 10, 10}, 1e200, {1, 1, 1}, {20, 20, 20});
    CHECK(whole.box == VoxelBox{{0, 0, 0}, {20, 20, 20}});
    CHECK(whole.contains({0, 0, 0}));
    for (const glm::dvec3& outside : {glm::dvec3(-5, 10, 10), glm::dvec3(10, 1e300, 10), glm::dvec3(10, 10, -1e300)}) {
        const BrushRegion region = make_region(RegionShape::box, outside, 3.0, {1, 1, 1}, {20, 20, 20});
        CHECK(region.box == VoxelBox{});
        CHECK(region.rows.empty());
        CHECK_FALSE(region.contains({0, 0, 0}));
    }
}

TEST_CASE("a radius or position that makes no region is refused by its value")
{
    const auto refusal = [](const glm::dvec3& centre, double radius) {
        return error_of([&] { make_region(RegionShape::ball, centre, radius, {1, 1, 1}, {600, 600, 600}); });
    };
    const glm::dvec3 middle(300.0);
    CHECK(refusal(middle, 0.0) == "brush radius is 0 voxels; expected a number above 0");
    CHECK(refusal(middle, -2.5) == "brush radius is -2.5 voxels; expected a number above 0");
    CHECK(refusal(middle, INFINITE) == "brush radius is inf voxels; expected a number above 0");
    CHECK(contains(refusal(middle, std::nan("")), "expected a number above 0"));
    CHECK(refusal({1, INFINITE, 1}, 1.0) == "brush position along y is inf; expected a finite number");
    CHECK(refusal({1, 1, -INFINITE}, 1.0) == "brush position along z is -inf; expected a finite number");
    CHECK(refusal({1e308, 1e308, 1e308}, 1.0).empty());
    CHECK(refusal(middle, 128.0).empty());
    CHECK(refusal(middle, 128.75) ==
          "brush radius is 128.75 voxels: its region is 258 x 258 x 258 voxels; expected at most 16777216 "
          "(256 x 256 x 256), each row filled up to a multiple of 32");
}

TEST_CASE("a radius that may come to be too large is refused wherever the brush is")
{
    const auto refused = [](double radius, const glm::dvec3& spacing, const Size3& size) {
        try {
            check_radius(radius, spacing, size);
        } catch (const Error&) {
            return true;
        }
        return false;
    };
    CHECK(!refused(127.99, {1, 1, 1}, {600, 600, 600}));
    CHECK(refused(128.0, {1, 1, 1}, {600, 600, 600}));  // 257 voxels, centred on one
    CHECK(refused(100.0, {2, 1, 1}, {600, 600, 600}));
    CHECK(!refused(100.0, {2, 1, 1}, {600, 100, 100}));
    CHECK(!refused(1e9, {1, 1, 1}, {256, 256, 256}));
}

TEST_CASE("what limits a region is its size in the volume, not the radius")
{
    CHECK(make_region(RegionShape::box, {64, 64, 64}, 500.0, {1, 1, 1}, {128, 128, 128}).box.size() == Size3(128));
    CHECK(make_region(RegionShape::box, {500, 500, 500}, 10.0, {20, 1, 20}, {1000, 1000, 1000}).box.size() ==
          Size3(20, 400, 20));
    CHECK_FALSE(error_of([] {
                    make_region(RegionShape::box, {32, 600, 600}, 32.0, {20, 1, 1}, {64, 1200, 1200});
                }).empty());
}

TEST_CASE("a stroke keeps its points and leaves no gap wider than a voxel along any axis")
{
    const uint32_t seed = 11;
    std::mt19937 random(seed);
    CAPTURE(seed);
    for (int i = 0; i < 200; ++i) {
        std::vector<glm::dvec3> path(1 + random() % 6);
        for (glm::dvec3& point : path) point = random_position(random, {90, 40, 10});
        const std::vector<glm::dvec3> positions = stroke_positions(path);
        REQUIRE(stroke_position_count(path) == double(positions.size()));
        size_t next_point = 0;
        double widest = 0.0;
        for (size_t k = 0; k < positions.size(); ++k) {
            if (next_point < path.size() && positions[k] == path[next_point]) ++next_point;
            if (k == 0) continue;
            const glm::dvec3 gap = glm::abs(positions[k] - positions[k - 1]);
            widest = std::max({widest, gap.x, gap.y, gap.z});
        }
        CHECK(next_point == path.size());
        CHECK(widest <= 1.0 + 1e-12);
    }
}

TEST_CASE("a stroke has no more positions than it needs, equally far apart")
{
    const glm::dvec3 a(1, 2, 3), b(5, 2, 1);
    const std::vector<glm::dvec3> dab{a}, straight{a, b};
    CHECK(stroke_positions({}).empty());
    CHECK(stroke_positions(dab) == dab);
    CHECK(stroke_positions(straight) == std::vector<glm::dvec3>{a, {2, 2, 2.5}, {3, 2, 2}, {4, 2, 1.5}, b});
    const std::vector<glm::dvec3> slow{{0, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0}};
    CHECK(stroke_positions(slow) == slow);
}

TEST_CASE("a stroke that is too long is refused, whatever its length")
{
    for (const double end : {1e6, 1e9, 1e300, 1.7e308}) {
        const std::vector<glm::dvec3> path{{-end, 0, 0}, {end, 0, 0}};
        CHECK(contains(error_of([&] { stroke_positions(path); }), "expected at most 1000000"));
    }
    const std::vector<glm::dvec3> longest{{0, 0, 0}, {999999, 0, 0}};
    CHECK(stroke_positions(longest).size() == 1000000);
}

TEST_CASE("a selection holds exactly the voxels of the regions that were added")
{
    for (uint32_t seed = 0; seed < 40; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const Size3 size(1 + random() % 90, 1 + random() % 70, 1 + random() % 40);
        const Sample samples[] = {random_sample(random, size), random_sample(random, size)};
        VoxelSelection selection(size);
        for (const Sample& sample : samples) selection.add(sample.region, sample.words);
        int64_t wrong = 0, count = 0;
        for_each_voxel(size, [&](const Size3& voxel) {
            const bool is_selected = has(samples[0], voxel) || has(samples[1], voxel);
            count += is_selected;
            wrong += selection.contains(voxel) != is_selected;
        });
        CHECK(wrong == 0);
        CHECK(selection.count() == count);
        for (const Size3& outside : {Size3(-1, 0, 0), Size3(0, size.y, 0), Size3(0, 0, size.z), Size3(size.x, 0, 0)})
            CHECK_FALSE(selection.contains(outside));
    }
}

TEST_CASE("painting gives every selected voxel the group, by the fewest records that say so")
{
    for (uint32_t seed = 0; seed < 40; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const Size3 size(1 + random() % 90, 1 + random() % 70, 1 + random() % 40);
        Document document{Mask(size)};
        for (int i = 0; i < 5; ++i) {
            const Sample sample = random_sample(random, size);
            VoxelSelection selection(size);
            selection.add(sample.region, sample.words);
            const auto group = uint8_t(random() % 3);
            const std::vector<Change> changes = as_changes(paint_changes(document.mask, selection, {group}));

            int64_t expected = 0, found = 0, wrong = 0;
            for_each_voxel(size, [&](const Size3& voxel) {
                expected += selection.contains(voxel) && document.mask.at(voxel) != group;
            });
            int64_t last_brick = -1;
            for (const Change& change : changes) {
                const auto& record = std::get<MaskBrickChange>(change);
                wrong += record.brick <= last_brick || record.runs.empty();
                last_brick = record.brick;
                found += record.voxels();
                for (size_t k = 0; k < record.runs.size(); ++k) {
                    const MaskRun& run = record.runs[k];
                    wrong += run.first > run.last || run.before == group || run.after != group;
                    if (k == 0) continue;
                    const MaskRun& previous = record.runs[k - 1];
                    wrong += previous.last >= run.first;
                    wrong += previous.last + 1 == run.first && previous.before == run.before;
                }
            }
            CHECK(found == expected);

            std::vector<uint8_t> before;
            for_each_voxel(size, [&](const Size3& voxel) { before.push_back(document.mask.at(voxel)); });
            for (const Change& change : changes) apply(document, change, Direction::forwards);
            size_t index = 0;
            for_each_voxel(size, [&](const Size3& voxel) {
                const uint8_t old = before[index++];
                wrong += document.mask.at(voxel) != (selection.contains(voxel) ? group : old);
            });
            CHECK(wrong == 0);
            CHECK(paint_changes(document.mask, selection, {group}).empty());
        }
    }
}
