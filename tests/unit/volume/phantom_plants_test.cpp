// Roots, stems and the helix: their truths, and the properties for which they were made.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <doctest/doctest.h>

#include "engine/volume/phantoms/phantom.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

Phantom plant(const std::string& kind, int64_t side, PhantomFlaws flaws = {})
{
    return make_phantom({.kind = kind, .size = Size3(side), .seed = 4, .flaws = flaws});
}

constexpr uint8_t DERMAL_GROUP = 10;

/// Parts of the graph: nodes - links + loops, as none of these graphs has loops.
size_t parts_of_forest(const Phantom& phantom)
{
    return phantom.nodes.size() - phantom.links.size();
}

/// Counts pairs of voxels, neighbours along an axis, of which one is in group `a` of the first mask, and the other in
/// group `b` of the second.
int64_t contacts(const std::vector<uint8_t>& first, uint8_t a, const std::vector<uint8_t>& second, uint8_t b, int64_t n)
{
    int64_t count = 0;
    for (int64_t i = 0; i < int64_t(first.size()); ++i)
        for (const int64_t step : {int64_t{1}, n, n * n}) {
            if (i + step >= int64_t(first.size()) || i % (step * n) + step >= step * n) continue;
            count += first[size_t(i)] == a && second[size_t(i + step)] == b;
            count += first[size_t(i + step)] == a && second[size_t(i)] == b;
        }
    return count;
}

}  // namespace

// Kind (phantoms): roots in soil, touched by stones and by other roots
TEST_CASE("roots are thick tubes in one piece with their shoot; stones touch them and lie nowhere in them")
{
    constexpr int64_t SIDE = 96;
    const Phantom roots = plant("roots", SIDE);
    CHECK(parts_of_forest(roots) == 1);
    const std::vector<uint8_t> mask = voxels_of<uint8_t>(*roots.mask), tissue = voxels_of<uint8_t>(*roots.tissue_mask);
    const uint8_t stone = roots.tissues.at("stone"), organic = roots.tissues.at("organic");
    int64_t in_both = 0, stones = 0, bits = 0;
    for (size_t i = 0; i < mask.size(); ++i) {
        in_both += mask[i] != 0 && tissue[i] != 0;
        stones += tissue[i] == stone;
        bits += tissue[i] == organic;
    }
    CHECK(in_both == 0);
    CHECK(stones > 15000);
    CHECK(bits > 500);
    const uint8_t main_root = roots.sections.at("main root"), lateral = roots.sections.at("lateral root"),
                  foreign = roots.sections.at("foreign root");
    CHECK(contacts(mask, main_root, tissue, stone, SIDE) > 20);
    // The roots of other plants are in no trace: one is fused with a main root, and one passes at 1.5 voxels.
    CHECK(std::ranges::none_of(roots.nodes, [&](const auto& node) { return node.group == foreign; }));
    CHECK(std::ranges::any_of(roots.nodes, [&](const auto& node) { return node.group == lateral; }));
    CHECK(contacts(mask, main_root, mask, foreign, SIDE) > 5);
    const std::vector<uint8_t> partial = voxels_of<uint8_t>(*roots.partial_mask);
    int64_t different = 0;
    for (size_t i = 0; i < mask.size(); ++i)
        different += partial[i] == 0 ? mask[i] != 0 && mask[i] != foreign : mask[i] == 0;
    CHECK(different == 0);
}

TEST_CASE("intensities of roots overlap those of soil and stones, and gaps show the soil")
{
    constexpr int64_t SIDE = 64;
    const Phantom whole = plant("roots", SIDE, {.noise = 0}), gappy = plant("roots", SIDE, {.noise = 0, .gaps = 40});
    const std::vector<uint8_t> mask = voxels_of<uint8_t>(*whole.mask), tissue = voxels_of<uint8_t>(*whole.tissue_mask);
    const std::vector<uint8_t> seen = voxels_of<uint8_t>(*whole.volume), broken = voxels_of<uint8_t>(*gappy.volume);
    int64_t above[4] = {}, of[4] = {}, dark = 0, dark_in_gaps = 0;  // of soil, roots, stones, organic bits
    for (size_t i = 0; i < mask.size(); ++i) {
        const int kind = mask[i] != 0 ? 1 : tissue[i] == 0 ? 0 : tissue[i] == whole.tissues.at("stone") ? 2 : 3;
        ++of[kind];
        above[kind] += seen[i] > 125;
        dark += mask[i] != 0 && seen[i] < 110;
        dark_in_gaps += mask[i] != 0 && broken[i] < 110;
    }
    CHECK(above[1] > of[1] * 8 / 10);
    CHECK(above[1] < of[1]);
    CHECK(above[2] > of[2] * 5 / 10);
    CHECK(above[3] > of[3] * 2 / 10);
    CHECK(above[0] > of[0] / 1000);
    CHECK(dark_in_gaps > dark + of[1] / 10);
    CHECK(voxels_of<uint8_t>(*gappy.mask) == mask);
    CHECK(usual_flaws("roots").gaps > 0.0);
}

// Kind (phantoms): bundles a voxel below dermal tissue that is nearly as bright
TEST_CASE("a stem's bundles are long and unjoined, a voxel or two below the dermal tissue")
{
    constexpr int64_t SIDE = 96;
    const Phantom stem = plant("stem", SIDE, {.noise = 0});
    CHECK(parts_of_forest(stem) == 8);
    std::set<size_t> from;
    for (const auto& link : stem.links) CHECK(from.insert(link[0]).second);  // no branches
    const std::vector<uint8_t> mask = voxels_of<uint8_t>(*stem.mask), tissue = voxels_of<uint8_t>(*stem.tissue_mask);
    const std::vector<uint8_t> seen = voxels_of<uint8_t>(*stem.volume);
    // Every slice is crossed by eight bundles, each less than 3 voxels from the dermal tissue somewhere.
    const uint8_t dermal = stem.tissues.at("dermal");
    double in_bundles = 0.0, in_dermal = 0.0;
    int64_t bundles = 0, dermis = 0, both = 0;
    for (size_t i = 0; i < mask.size(); ++i) {
        both += mask[i] != 0 && tissue[i] == dermal;
        if (mask[i] != 0) in_bundles += seen[i], ++bundles;
        if (tissue[i] == dermal) in_dermal += seen[i], ++dermis;
    }
    CHECK(both == 0);
    CHECK(in_bundles / double(bundles) > 160.0);
    CHECK(in_dermal / double(dermis) > 120.0);
    CHECK(in_dermal / double(dermis) < in_bundles / double(bundles) - 20.0);
    const double inner = stem.facts.at("dermal_inner_radius_voxels")[0];
    std::vector<double> least(8, 99.0);
    for (size_t i = 0; i < stem.nodes.size(); ++i) {
        const glm::dvec3 at = stem.nodes[i].voxel;
        const double t = at.z / SIDE, bend = 0.05 * (4.0 * t * (1.0 - t) - 0.5);
        const glm::dvec2 axis = glm::dvec2(0.5 * SIDE) + SIDE * bend * glm::dvec2(0.8, 0.6);
        const double gap = inner - glm::length(glm::dvec2(at) - axis) - stem.nodes[i].radius_voxels;
        CHECK(gap > 0.4);
        least[i / 25] = std::min(least[i / 25], gap);
    }
    CHECK(*std::ranges::max_element(least) < 1.5);
    for (const int64_t z : {int64_t{0}, SIDE / 2, SIDE - 1})
        CHECK(std::any_of(mask.begin() + z * SIDE * SIDE, mask.begin() + (z + 1) * SIDE * SIDE,
                          [](uint8_t group) { return group != 0; }));
}

TEST_CASE(
    "with double tubes, a stem's and a section's phloem lie apart from the xylem and, in the stem, from the dermis")
{
    for (const char* kind : {"stem", "section"}) {
        CAPTURE(kind);
        PhantomSpec spec{.kind = kind, .size = Size3(96)};
        const Phantom plain = make_phantom(spec);
        const std::vector<uint8_t> single = voxels_of<uint8_t>(*plain.mask),
                                   tissue_of_single = voxels_of<uint8_t>(*plain.tissue_mask);
        spec.double_tubes = true;
        const Phantom doubled = make_phantom(spec);
        const std::vector<uint8_t> both = voxels_of<uint8_t>(*doubled.mask),
                                   tissue = voxels_of<uint8_t>(*doubled.tissue_mask);
        const auto painted = [](const std::vector<uint8_t>& mask) {
            return std::ranges::count_if(mask, [](uint8_t group) { return group != 0; });
        };
        CHECK(painted(both) > painted(single) * 5 / 4);
        CHECK(std::ranges::count(tissue, DERMAL_GROUP) == std::ranges::count(tissue_of_single, DERMAL_GROUP));
    }
}

TEST_CASE("a helix has the length, the curvature and the mask that formulas give")
{
    constexpr int64_t SIDE = 80;
    const Phantom helix = plant("helix", SIDE);
    const auto fact = [&](const char* name) { return helix.facts.at(name).at(0); };
    const double radius = 0.30 * SIDE, pitch = 0.24 * SIDE, tube = helix.nodes[0].radius_voxels;
    const double rise = pitch / (2.0 * std::numbers::pi);
    CHECK(fact("curvature_per_voxel") == doctest::Approx(radius / (radius * radius + rise * rise)).epsilon(1e-12));
    CHECK(fact("torsion_per_voxel") == doctest::Approx(rise / (radius * radius + rise * rise)).epsilon(1e-12));
    const double length = 3.0 * std::hypot(2.0 * std::numbers::pi * radius, pitch);
    CHECK(fact("length_voxels") == doctest::Approx(length).epsilon(1e-12));
    double links = 0.0;
    for (const auto& [from, to] : helix.links) links += glm::length(helix.nodes[to].voxel - helix.nodes[from].voxel);
    CHECK(fact("length_of_links_voxels") == doctest::Approx(links).epsilon(1e-12));
    CHECK(links < length);
    CHECK(links > 0.999 * length);

    // Each node lies on the helix: right-handed, so that it turns counter-clockwise as it rises.
    double turned = 0.0;
    for (size_t i = 0; i < helix.nodes.size(); ++i) {
        const glm::dvec3 p = helix.nodes[i].voxel - glm::dvec3(0.5 * SIDE);
        CHECK(std::hypot(p.x, p.y) == doctest::Approx(radius).epsilon(1e-12));
        if (i == 0) continue;
        const glm::dvec3 q = helix.nodes[i - 1].voxel - glm::dvec3(0.5 * SIDE);
        const double step = std::atan2(q.x * p.y - q.y * p.x, q.x * p.x + q.y * p.y) / (2.0 * std::numbers::pi);
        CHECK(p.z - q.z == doctest::Approx(pitch * step).epsilon(1e-9));
        turned += step;
    }
    CHECK(turned == doctest::Approx(3.0).epsilon(1e-12));
    // The volume of a tube without ends, within what a link's arc rises above its chord.
    const std::vector<uint8_t> mask = voxels_of<uint8_t>(*helix.mask);
    const double voxels = double(std::ranges::count(mask, 1));
    const double closed = std::numbers::pi * tube * tube * (length + 4.0 / 3.0 * tube);
    CHECK(voxels == doctest::Approx(closed).epsilon(0.01));
}

TEST_CASE("facts of a flower head give the axis, the divergence angle and the handedness of its graph")
{
    for (const auto& [phyllotaxis, degrees, jugacy] : {std::tuple("fibonacci", 137.50776405003785, 1.0),
                                                       {"lucas", 99.50155281000757, 1.0},
                                                       {"bijugate", 68.75388202501893, 2.0}}) {
        const Phantom head = make_phantom({.size = Size3(40), .phyllotaxis = phyllotaxis, .left_handed = true});
        CHECK(head.facts.at("divergence_degrees")[0] == doctest::Approx(degrees).epsilon(1e-12));
        CHECK(head.facts.at("jugacy")[0] == jugacy);
        CHECK(head.facts.at("handedness")[0] == -1.0);
        CHECK(head.facts.at("axis_through_voxels") == std::vector<double>{20.0, 20.0, 20.0});
        CHECK(head.facts.at("axis_direction") == std::vector<double>{0.0, 0.0, 1.0});
        CHECK(head.facts.at("head_radius_voxels")[0] == doctest::Approx(16.0));
    }
}
