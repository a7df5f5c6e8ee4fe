// The hierarchy of boxes around opaque surfaces, before a device sees it.

#include "engine/look/surfaces/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const VolumeInfo VOLUME = volume_of_size(Size3(1000), {0.5, 0.5, 2.0});

std::vector<SurfaceLook> rods(size_t count, double extent, uint32_t seed)
{
    std::mt19937 random(seed);
    const auto within = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
    std::vector<SurfaceLook> surfaces(count);
    for (SurfaceLook& rod : surfaces) {
        rod.from = {within(0, extent), within(0, extent), within(0, extent)};
        rod.to = rod.from + glm::dvec3(within(-3, 3), within(-3, 3), within(-3, 3));
        rod.radius_from = within(0.05, 0.5);
        rod.radius_to = within(0.05, 0.5);
    }
    return surfaces;
}

SurfaceTree tree_of(const std::vector<SurfaceLook>& surfaces)
{
    return surface_tree(keyed(surfaces), VOLUME);
}

/// Checks that every surface is in one leaf and inside the boxes above it, and children inside their parent, in order.
void check_tree(const SurfaceTree& tree, size_t max_in_leaf)
{
    REQUIRE(!tree.nodes.empty());
    size_t next_surface = 0, wrong = 0;
    std::vector<std::pair<size_t, size_t>> open;  // nodes around this one, and where they end
    for (size_t node = 0; node < tree.nodes.size(); ++node) {
        const gpu::SurfaceNode& box = tree.nodes[node];
        while (!open.empty() && open.back().second == node) open.pop_back();
        REQUIRE((box.skip > node && box.skip <= (open.empty() ? tree.nodes.size() : open.back().second)));
        const bool is_leaf = box.end > box.begin;
        CHECK((is_leaf ? box.skip == node + 1 : box.skip > node + 2));
        if (is_leaf) {
            wrong += box.begin != next_surface || box.end - box.begin > max_in_leaf;
            next_surface = box.end;
            for (size_t i = box.begin; i < box.end; ++i) {
                const gpu::Surface& surface = tree.list[i];
                const glm::dvec3 from = glm::dvec3(surface.from) + glm::dvec3(surface.from_rest);
                const glm::dvec3 to = from + glm::dvec3(surface.along);
                const glm::dvec3 lower = glm::min(from - double(surface.radius_from), to - double(surface.radius_to));
                const glm::dvec3 upper = glm::max(from + double(surface.radius_from), to + double(surface.radius_to));
                wrong += !glm::all(glm::lessThanEqual(glm::dvec3(box.lower), lower)) ||
                         !glm::all(glm::greaterThanEqual(glm::dvec3(box.upper), upper));
            }
        }
        if (!open.empty()) {
            const gpu::SurfaceNode& parent = tree.nodes[open.back().first];
            wrong += !glm::all(glm::lessThanEqual(parent.lower, box.lower)) ||
                     !glm::all(glm::greaterThanEqual(parent.upper, box.upper));
        }
        open.emplace_back(node, box.skip);
    }
    CHECK(wrong == 0);
    CHECK(next_surface == tree.list.size());
    CHECK(tree.nodes[0].skip == tree.nodes.size());
}

std::string refusal(const SurfaceLook& surface)
{
    return error_of([&] { static_cast<void>(tree_of({SurfaceLook{}, surface})); });
}

}  // namespace

TEST_CASE("every surface is in one leaf, inside every box around it")
{
    for (const size_t count : {1, 4, 5, 37, 3000}) {
        const SurfaceTree tree = tree_of(rods(count, 100.0, 21));
        CHECK(tree.list.size() == count);
        check_tree(tree, gpu::SURFACES_IN_LEAF);
        std::vector<bool> seen(count);
        for (const gpu::Surface& surface : tree.list) seen[surface.number] = true;
        CHECK(std::ranges::count(seen, true) == ptrdiff_t(count));
    }
    // Identical ones, and one that outweighs all others.
    check_tree(tree_of(std::vector<SurfaceLook>(5000)), gpu::SURFACES_IN_LEAF);
    std::vector<SurfaceLook> uneven = rods(2000, 1e-3, 22);
    uneven.push_back({.from = glm::dvec3(5e5), .to = glm::dvec3(5e5), .radius_from = 3.0, .radius_to = 3.0});
    check_tree(tree_of(uneven), gpu::SURFACES_IN_LEAF);
    CHECK(tree_of({}).nodes.empty());
}

TEST_CASE("a hundred thousand rods are sorted in far less than a second")
{
    const std::vector<SurfaceLook> many = rods(100'000, 500.0, 23);
    const std::clock_t begun = std::clock();
    const SurfaceTree tree = tree_of(many);
    const double seconds = double(std::clock() - begun) / CLOCKS_PER_SEC;  // CPU time, however busy the processor is
    MESSAGE("100000 rods: " << seconds * 1e3 << " ms, " << tree.nodes.size() << " nodes");
    CHECK(seconds < 1.0);
    CHECK(tree.nodes.size() < 2 * tree.list.size());
    check_tree(tree, gpu::SURFACES_IN_LEAF);
}

TEST_CASE("positions keep what a float of their size loses, in units of the finest axis")
{
    const glm::dvec3 from(30000.123456, 20000.7654321, 0.1), to(30001.0, 20000.0, 2.3);
    const SurfaceTree tree = tree_of({{from, to, 0.25, 0.125, glm::dvec3(0.5)}});
    const gpu::Surface& surface = tree.list.at(0);
    CHECK(glm::distance(glm::dvec3(surface.from) + glm::dvec3(surface.from_rest), from / 0.5) < 1e-9);
    CHECK(glm::distance(glm::dvec3(surface.along), (to - from) / 0.5) < 1e-6);
    CHECK(surface.radius_from == 0.5f);
    CHECK(surface.radius_to == 0.25f);
}

TEST_CASE("a ball in the other end's ball leaves that one alone")
{
    for (const bool swapped : {false, true}) {
        SurfaceLook rod{{10, 10, 10}, {11, 10, 10}, 5.0, 1.0};
        if (swapped) std::swap(rod.from, rod.to), std::swap(rod.radius_from, rod.radius_to);
        const gpu::Surface surface = tree_of({rod}).list.at(0);
        CHECK(surface.along == glm::vec3(0.0f));
        CHECK(surface.from == glm::vec3(20.0f));
        CHECK(surface.radius_from == 10.0f);
    }
    CHECK(tree_of({{{10, 10, 10}, {14.1, 10, 10}, 5.0, 1.0}}).list.at(0).along.x > 8.0f);
}

TEST_CASE("surfaces that cannot be drawn are refused with what is wrong about them")
{
    CHECK(refusal({.from = {0, 0, NAN}}).starts_with("surface 1: an end is at (0, 0, nan); expected -524288 ... "));
    CHECK(refusal({.to = {2e6, 0, 0}}).starts_with("surface 1: an end is at (2e+06, 0, 0); expected "));
    CHECK(refusal({.radius_from = 0.0}) == "surface 1: a radius is 0; expected more than 0 and at most 524288");
    CHECK(refusal({.radius_to = INFINITY}).starts_with("surface 1: a radius is inf; expected"));
    CHECK(refusal({.color = {0, NAN, 0}}).starts_with("surface 1: its colour is not finite"));
    CHECK(refusal({}).empty());
    CHECK_THROWS_AS(tree_of(std::vector<SurfaceLook>(MAX_SURFACES + 1)), Error);
}
