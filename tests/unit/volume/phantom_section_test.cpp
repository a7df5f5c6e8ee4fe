// The section of the thesis's study (chapter 6): its graph, and its truth's own row of table 6.1.

#include <algorithm>
#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "engine/volume/phantoms/phantom.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr int64_t SECTION_SIDE = 96;

/// The share of a ball's voxels that are painted.
double share_of(const std::vector<uint8_t>& mask, const glm::dvec3& centre, double radius)
{
    int64_t painted = 0, all = 0;
    const Size3 lower(glm::floor(centre - radius)), upper(glm::floor(centre + radius));
    for (int64_t z = lower.z; z <= upper.z; ++z)
        for (int64_t y = lower.y; y <= upper.y; ++y)
            for (int64_t x = lower.x; x <= upper.x; ++x) {
                const glm::dvec3 d = glm::dvec3(x, y, z) + 0.5 - centre;
                if (d.x * d.x + d.y * d.y + d.z * d.z > radius * radius) continue;
                ++all;
                painted += mask[size_t(x + SECTION_SIDE * (y + SECTION_SIDE * z))] != 0;
            }
    return double(painted) / double(all);
}

}  // namespace

TEST_CASE("the section's graph is that of the thesis: 70 nodes, 71 internodes, 26 segments, 2 loops")
{
    const Phantom section = make_phantom({.kind = "section", .size = Size3(16)});
    CHECK(section.nodes.size() == 70);
    CHECK(section.links.size() == 71);  // 2 loops, as it is in one piece: 71 - 70 + 1
    std::map<size_t, int> degree;
    std::vector<size_t> part(section.nodes.size());
    for (size_t i = 0; i < part.size(); ++i) part[i] = i;
    for (const auto& [from, to] : section.links) {
        ++degree[from];
        ++degree[to];
        const size_t old = part[to], now = part[from];
        std::ranges::replace(part, old, now);
    }
    CHECK(std::ranges::count(part, part[0]) == 70);
    int ends_of_segments = 0;
    for (const auto& [node, links] : degree) ends_of_segments += links == 2 ? 0 : links;
    CHECK(ends_of_segments == 2 * 26);
}

TEST_CASE("the section's own truth scores as the thesis's: Dice .824, nodes .971, internodes .99 or more, none out")
{
    for (const uint32_t seed : {1u, 5u}) {
        CAPTURE(seed);
        const Phantom section = make_phantom({.kind = "section", .size = Size3(SECTION_SIDE), .seed = seed});
        const std::vector<uint8_t> full = voxels_of<uint8_t>(*section.mask);
        const std::vector<uint8_t> partial = voxels_of<uint8_t>(*section.partial_mask);
        int64_t in_full = 0, in_partial = 0, outside = 0;
        for (size_t i = 0; i < full.size(); ++i) {
            in_full += full[i] != 0;
            in_partial += partial[i] != 0;
            outside += partial[i] != 0 && full[i] == 0;
        }
        CHECK(outside == 0);
        CHECK(2.0 * double(in_partial) / double(in_full + in_partial) == doctest::Approx(0.824).epsilon(0.005 / 0.824));

        double nodes = 0.0, internodes = 0.0, least = 1.0;
        for (const auto& node : section.nodes) {
            const double share = share_of(full, node.voxel, node.radius_voxels);
            nodes += share / 70.0;
            least = std::min(least, share);
        }
        for (const auto& [from, to] : section.links) {
            const ProceduralTruth::Node &a = section.nodes[from], &b = section.nodes[to];
            const double share = share_of(full, 0.5 * (a.voxel + b.voxel), 0.5 * (a.radius_voxels + b.radius_voxels));
            internodes += share / 71.0;
            least = std::min(least, share);
        }
        CHECK(std::abs(nodes - 0.971) <= 0.01);
        CHECK(internodes >= 0.99);
        CHECK(least > 0.5);
    }
}

TEST_CASE("separate bundles of the section are in no trace, one of them fused with a vein of it, one 1.5 voxels away")
{
    const Phantom section = make_phantom({.kind = "section", .size = Size3(SECTION_SIDE)});
    CHECK(std::ranges::none_of(section.nodes, [](const auto& node) { return node.group == 4; }));
    const std::vector<uint8_t> full = voxels_of<uint8_t>(*section.mask);
    int64_t touching = 0;
    for (size_t i = 0; i + 1 < full.size(); ++i) touching += full[i] != 0 && full[i + 1] != 0 && full[i] != full[i + 1];
    CHECK(touching > 0);
}
