#include "engine/annotation/measures/measures.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <set>

#include <doctest/doctest.h>

#include "engine/volume/unit.h"
#include "tests/support/slow.h"
#include "tests/support/traces.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A mask with the groups of `group_at`, `scale` voxels wide along each axis.
Mask mask_of(const Size3& size, const std::function<int(int64_t, int64_t, int64_t)>& group_at, int64_t scale = 1)
{
    Mask mask(size * scale);
    const Size3 counts = mask.brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; ++brick) {
        MaskBrickChange change{brick, {}};
        const VoxelBox box = mask.box_of(brick);
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                    const size_t place = index_in_brick({x, y, z});
                    append_run(change.runs, place, place, uint8_t{0},
                               uint8_t(group_at(x / scale, y / scale, z / scale)));
                }
        if (!change.runs.empty()) mask.apply(change, Direction::forwards);
    }
    return mask;
}

using Cells = std::set<std::array<int, 3>>;

/// Number of connected parts of a set of cells, over faces (6) or over faces, edges and corners (26).
int64_t parts_of(Cells rest, bool over_corners)
{
    int64_t parts = 0;
    for (; !rest.empty(); ++parts) {
        std::vector<std::array<int, 3>> waiting{*rest.begin()};
        rest.erase(rest.begin());
        while (!waiting.empty()) {
            const auto at = waiting.back();
            waiting.pop_back();
            for (int step = 0; step < 27; ++step) {
                const std::array<int, 3> by{step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
                if (!over_corners && std::abs(by[0]) + std::abs(by[1]) + std::abs(by[2]) != 1) continue;
                const std::array<int, 3> next{at[0] + by[0], at[1] + by[1], at[2] + by[2]};
                if (rest.erase(next) > 0) waiting.push_back(next);
            }
        }
    }
    return parts;
}

/// By the definition: all cells of all cubes in one set, parts by flooding.
Topology slow_topology(const Mask& mask, std::optional<uint8_t> group = {})
{
    Cells painted, unpainted, cells;
    const Size3 size = mask.size();
    for (int z = -1; z <= size.z; ++z)
        for (int y = -1; y <= size.y; ++y)
            for (int x = -1; x <= size.x; ++x) {
                const bool inside = x >= 0 && y >= 0 && z >= 0 && x < size.x && y < size.y && z < size.z;
                const bool is_painted = inside && (group ? mask.at({x, y, z}) == *group : mask.at({x, y, z}) != 0);
                (is_painted ? painted : unpainted).insert({x, y, z});
                // In doubled coordinates a cube is odd along three axes, a vertex along none.
                for (int step = 0; is_painted && step < 27; ++step)
                    cells.insert({2 * x + step % 3, 2 * y + step / 3 % 3, 2 * z + step / 9});
            }
    int64_t euler = 0;
    for (const auto& cell : cells) euler += (cell[0] % 2 + cell[1] % 2 + cell[2] % 2) % 2 == 0 ? 1 : -1;
    const int64_t b0 = parts_of(painted, true), b2 = parts_of(unpainted, false) - 1;
    return {b0, b0 + b2 - euler, b2};
}

double from_centre(int64_t x, int64_t y, int64_t z, double cx, double cy, double cz)
{
    return std::hypot(double(x) + 0.5 - cx, double(y) + 0.5 - cy, double(z) + 0.5 - cz);
}

}  // namespace

TEST_CASE("a segment's length, chord, tortuosity and radii")
{
    // Along two sides of a 3-4-5 triangle.
    TraceGraph trace = trace_of({{{0, 0, 0}, 1, 2}, {{3, 0, 0}, 3, 2}, {{3, 4, 0}, 2, 2}}, {{0, 1, 4}, {2, 1, 5}});
    const TraceMeasures measures = measure(trace);
    REQUIRE(measures.segments.size() == 1);
    const SegmentMeasures& segment = measures.segments[0];
    CHECK(segment.length == 7.0);
    CHECK(segment.chord == 5.0);
    CHECK(segment.tortuosity.value() == doctest::Approx(1.4).epsilon(1e-15));
    CHECK(segment.radius_mean == doctest::Approx((3.0 * 2.0 + 4.0 * 2.5) / 7.0).epsilon(1e-15));
    CHECK(segment.radius_least == 1.0);
    CHECK(segment.radius_most == 3.0);
    CHECK(segment.group == 5);  // the longer half
    CHECK((measures.length_by_group == std::map<uint8_t, double>{{4, 3.0}, {5, 4.0}}));
    CHECK((measures.nodes_by_group == std::map<uint8_t, int64_t>{{2, 3}}));
    CHECK(measures.ends == 2);
    trace.apply(TraceSizeChange{4, {}, 0.5}, Direction::forwards);
    CHECK(measure(trace).segments[0].radius_least == 0.5);
}

TEST_CASE("the angles at a branch")
{
    const TraceMeasures measures = measure(
        trace_of({{{0, 0, 0}, 1, 3}, {{2, 0, 0}, 1, 1}, {{0, 5, 0}, 1, 1}, {{-1, 1e-9, 0}, 1, 1}, {{9, 0, 0}, 1, 1}},
                 {{0, 1, 1}, {2, 0, 1}, {0, 3, 1}}));
    REQUIRE(measures.branches.size() == 1);
    CHECK(measures.branches[0].node == 0);
    CHECK(measures.branches[0].group == 3);
    REQUIRE(measures.branches[0].angles_degrees.size() == 3);
    CHECK(measures.branches[0].angles_degrees[0] == 90.0);
    // An angle so close to 180 that the arc cosine would return exactly 180.
    CHECK(180.0 - measures.branches[0].angles_degrees[1] ==
          doctest::Approx(1e-9 * 180.0 / std::numbers::pi).epsilon(1e-4));
    CHECK(measures.topology == Topology{2, 0, 0});
}

TEST_CASE("Betti numbers of traces")
{
    const std::vector<TraceNode> nodes(5);
    CHECK(topology_of(trace_of({}, {})) == Topology{});
    CHECK(topology_of(trace_of(nodes, {})) == Topology{5, 0, 0});
    CHECK(topology_of(trace_of(nodes, {{0, 1, 1}, {1, 2, 1}, {2, 0, 1}})) == Topology{3, 1, 0});
    std::vector<TraceInternode> all;
    for (uint32_t a = 0; a < 5; ++a)
        for (uint32_t b = 0; b < a; ++b) all.push_back({a, b, 1});
    CHECK(topology_of(trace_of(nodes, all)) == Topology{1, 6, 0});
}

TEST_CASE("Betti numbers of a ball, a torus, a shell and what they make together")
{
    const auto ball = [](int64_t x, int64_t y, int64_t z) { return from_centre(x, y, z, 20, 20, 20) < 9.0; };
    const auto shell = [](int64_t x, int64_t y, int64_t z) {
        const double r = from_centre(x, y, z, 20, 20, 20);
        return r < 15.0 && r > 11.0;
    };
    const auto torus = [](double cx, int64_t x, int64_t y, int64_t z) {
        const double ring = std::hypot(double(x) + 0.5 - cx, double(y) + 0.5 - 20.0) - 10.0;
        return std::hypot(ring, double(z) + 0.5 - 31.5) < 3.0;  // across the seam of two bricks
    };
    const Size3 size(70, 41, 50);
    CHECK(topology_of(Mask(size)) == Topology{});
    CHECK(topology_of(mask_of(size, ball)) == Topology{1, 0, 0});
    CHECK(topology_of(mask_of(size, shell)) == Topology{1, 0, 1});
    CHECK(topology_of(mask_of(size, [&](auto... at) { return ball(at...) || shell(at...); })) == Topology{2, 0, 1});
    CHECK(topology_of(mask_of(size, [&](auto... at) { return torus(32.0, at...); })) == Topology{1, 1, 0});
    // Two that touch are a figure of eight, and far apart two of one.
    CHECK(topology_of(mask_of(size, [&](auto... at) { return torus(20.0, at...) || torus(44.0, at...); })) ==
          Topology{1, 2, 0});
    // A ball that fills the volume up to its border has no cavity, nor do its surroundings.
    CHECK(topology_of(mask_of({8, 8, 8}, [](auto...) { return 1; })) == Topology{1, 0, 0});
    const Mask two = mask_of(size, [&](auto... at) { return ball(at...) ? 1 : shell(at...) ? 2 : 0; });
    CHECK(topology_of(two, 1) == Topology{1, 0, 0});
    CHECK(topology_of(two, 2) == Topology{1, 0, 1});
    CHECK(topology_of(two, 3) == Topology{});
}

TEST_CASE("painted voxels are connected over corners, unpainted ones over faces")
{
    const Size3 size(4, 4, 4);
    CHECK(topology_of(mask_of(size, [](int64_t x, int64_t y, int64_t z) { return x == y && y == z; })) ==
          Topology{1, 0, 0});
    // Open only at edges and corners: still a cavity.
    const Size3 three(3, 3, 3);
    CHECK(topology_of(mask_of(three, [](int64_t x, int64_t y, int64_t z) {
              return std::abs(x - 1) + std::abs(y - 1) + std::abs(z - 1) == 1;
          })) == Topology{1, 0, 1});
}

TEST_CASE("Betti numbers of random masks are those of their definition")
{
    for (uint32_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const Size3 size(1 + random() % 9, 1 + random() % 9, 1 + random() % 9);
        const auto share = 1 + random() % 9;
        const Mask mask = mask_of(size, [&](auto...) { return random() % 10 < share ? 1 + random() % 3 : 0; });
        CHECK(topology_of(mask) == slow_topology(mask));
    }
    // Wider than a word, over several bricks.
    std::mt19937 random(9);
    const Mask wide = mask_of({131, 5, 4}, [&](auto...) { return random() % 10 < 3; });
    CHECK(topology_of(wide) == slow_topology(wide));
    CHECK(topology_of(wide).loops > 100);
}

TEST_CASE("Betti numbers of each group are those of its own voxels, in whole, cut and missing bricks")
{
    for (uint32_t seed = 1; seed <= repeats(10u, 500u); ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        const Size3 size(1 + random() % 5, 1 + random() % 5, 1 + random() % 5);
        const auto share = 2 + random() % 8;
        std::map<std::array<int64_t, 3>, int> groups;
        const auto group_at = [&](int64_t x, int64_t y, int64_t z) {
            const auto [found, is_new] = groups.try_emplace({x, y, z});
            if (is_new) found->second = random() % 10 < share ? int(1 + random() % 2) : 0;
            return found->second;
        };
        // Larger voxels have the same topology: whole bricks (32), and parts of them.
        const Mask small = mask_of(size, group_at);
        std::map<int, Topology> expected{{ALL_GROUPS, slow_topology(small)}};
        for (const uint8_t group : std::initializer_list<uint8_t>{1, 2})
            if (small.voxels_by_group()[group] > 0) expected[group] = slow_topology(small, group);
        for (const int64_t scale : {1, 8, 11, 32}) {
            CAPTURE(scale);
            CHECK(topology_by_group(mask_of(size, group_at, scale)) == expected);
        }
    }
}

TEST_CASE("Betti numbers of voxels at the corners of the largest volume cost what is painted")
{
    Mask mask{Size3(MAX_SIDE)};
    const Size3 last = mask.brick_counts() - int64_t{1};
    uint8_t group = 0;
    for (const int64_t z : {int64_t{0}, last.z})
        for (const int64_t y : {int64_t{0}, last.y})
            for (const int64_t x : {int64_t{0}, last.x})
                mask.apply({index_of({x, y, z}, mask.brick_counts()), {{0, 0, 0, ++group}, {2, 2, 0, group}}},
                           Direction::forwards);
    std::map<int, Topology> expected{{ALL_GROUPS, {16, 0, 0}}};
    for (int one = 1; one <= group; ++one) expected[one] = {2, 0, 0};
    CHECK(topology_by_group(mask) == expected);
    CHECK(topology_by_group(Mask(Size3(MAX_SIDE))) == std::map<int, Topology>{{ALL_GROUPS, {}}});
}

TEST_CASE("units of length")
{
    CHECK(micrometres_in("um") == 1.0);
    CHECK(micrometres_in("mm") == 1000.0);
    CHECK(!micrometres_in("voxel"));
}

TEST_CASE("the table has a unit in every row, and fields that could be taken for something else are quoted")
{
    TraceGraph trace = trace_of({{{0, 0, 0}, 1, 2}, {{3, 0, 0}, 3, 2}}, {{0, 1, 4}});
    std::array<int64_t, 256> voxels{};
    voxels[3] = 8;
    const auto table = [&](const std::string& unit) {
        return metrics_csv(measure(trace), voxels, {{-1, {1, 2, 3}}}, {{9, 9, 9}, {0.5, 0.5, 2}, unit});
    };
    const std::string text = table("um");
    CHECK(text.starts_with("item,number,group,measure,value,unit\r\n"));
    CHECK(contains(text, "mask,,3,voxels,8,voxel\r\nmask,,3,volume,4,um^3\r\n"));
    CHECK(contains(text, "mask,,,components,1,1\r\nmask,,,loops,2,1\r\nmask,,,cavities,3,1\r\n"));
    CHECK(contains(text, "trace,,4,length,3,um\r\n"));
    CHECK(contains(text, "segment,0,4,radius_mean,2,um\r\n"));
    size_t rows = 0;
    for (size_t at = 0; (at = text.find("\r\n", at)) != std::string::npos; ++at) ++rows;
    size_t commas = size_t(std::count(text.begin(), text.end(), ','));
    CHECK(commas == 5 * rows);
    CHECK(contains(table("a,\"b"), "trace,,4,length,3,\"a,\"\"b\"\r\n"));
    CHECK(contains(table("=1+1"), "trace,,4,length,3,'=1+1\r\n"));
}
