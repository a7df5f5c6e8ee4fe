// Surfaces of groups on noise, contacts over edges and corners, and shapes with known areas.

#include <cmath>
#include <numbers>
#include <set>

#include "tests/unit/annotation/meshes/mesh_checks.h"

using namespace shvr;
using namespace shvr::test;

namespace {

DenseGroups empty_groups(const Size3& size)
{
    return {size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
}

/// Voxels of groups 1 to `groups`, each painted with the given probability.
DenseGroups noise(std::mt19937& random, const Size3& size, double painted, int groups)
{
    DenseGroups dense = empty_groups(size);
    for (uint8_t& group : dense.groups)
        if (double(random() % 1000) < 1000.0 * painted) group = uint8_t(1 + int(random() % uint32_t(groups)));
    return dense;
}

std::set<uint8_t> groups_of(const DenseGroups& dense)
{
    std::set<uint8_t> groups(dense.groups.begin(), dense.groups.end());
    groups.erase(0);
    return groups;
}

/// Faces between two groups.
size_t faces_between(const DenseGroups& dense, uint8_t a, uint8_t b)
{
    size_t faces = 0;
    reference::for_each_voxel(dense.size, [&](const Size3& voxel) {
        for (int axis = 0; axis < 3; ++axis) {
            Size3 other = voxel;
            ++other[axis];
            const uint8_t here = dense.at(voxel), there = group_at(dense, other);
            faces += size_t((here == a && there == b) || (here == b && there == a));
        }
    });
    return faces;
}

void check_surfaces(const DenseGroups& dense, const glm::dvec3& spacing)
{
    const Mask mask = mask_of(dense);
    GroupSurfaces plain(mask, {.spacing = spacing}), smooth(mask, {.steps = 20, .spacing = spacing});
    std::map<uint8_t, TestMesh> before, after;
    for (const uint8_t group : groups_of(dense)) {
        CAPTURE(int(group));
        const TestMesh& mesh = before[group] = mesh_of(plain, group);
        const TestMesh& moved = after[group] = mesh_of(smooth, group);
        check_closed_manifold(mesh);
        check_closed_manifold(moved);
        check_sides(mesh, dense, group);
        CHECK(euler_characteristic(mesh) == expected_euler_characteristic(dense, group));
        CHECK(euler_characteristic(moved) == euler_characteristic(mesh));
        const double voxels = double(mask.voxels_by_group()[group]);
        CHECK(mesh.volume() == doctest::Approx(voxels).epsilon(1e-12));
        CHECK(moved.volume() == doctest::Approx(voxels).epsilon(0.01));
        double farthest = 0.0;
        REQUIRE(moved.vertices.size() == mesh.vertices.size());
        for (size_t i = 0; i < mesh.vertices.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                farthest = std::max(farthest, std::abs(moved.vertices[i][axis] - mesh.vertices[i][axis]));
        CHECK(farthest < 0.5);
    }
    for (const auto& [a, of_a] : before)
        for (const auto& [b, of_b] : before) {
            if (a >= b) continue;
            CAPTURE(int(a));
            CAPTURE(int(b));
            const size_t shared = shared_triangles(of_a, of_b);
            CHECK(shared >= 2 * faces_between(dense, a, b));
            CHECK((shared == 0) == (faces_between(dense, a, b) == 0));
            CHECK(shared_triangles(after[a], after[b]) == shared);
        }
}

/// Paints the octants of corner (1, 1, 1) whose bits are set.
void paint_octants(DenseGroups& dense, uint8_t octants, uint8_t group)
{
    for (int i = 0; i < 8; ++i)
        if ((octants >> i & 1) != 0) dense.at({i & 1, i >> 1 & 1, i >> 2}) = group;
}

DenseGroups ball(const Size3& size, const glm::dvec3& centre, double radius, const glm::dvec3& spacing)
{
    DenseGroups dense = empty_groups(size);
    reference::for_each_voxel(size, [&](const Size3& voxel) {
        const glm::dvec3 from = spacing * (glm::dvec3(voxel) + 0.5) - centre;
        if (glm::length(from) <= radius) dense.at(voxel) = from.x < 0.0 ? 1 : 2;
    });
    return dense;
}

}  // namespace

// Kind (operations on groups): voxels that touch over edges and corners, in surfaces
TEST_CASE("surfaces around one corner are closed manifolds, whatever octants are painted")
{
    for (int octants = 1; octants < 256; ++octants) {
        CAPTURE(octants);
        DenseGroups dense = empty_groups({2, 2, 2});
        paint_octants(dense, uint8_t(octants), 1);
        check_surfaces(dense, {1, 1, 1});
        if (octants % 8 != 6) continue;
        paint_octants(dense, uint8_t(~octants), 2);
        check_surfaces(dense, {1, 1, 1});
    }
}

TEST_CASE("surfaces of noise are closed manifolds that share borders, with the volumes of their voxels")
{
    std::mt19937 random(7);
    for (const Size3& size : {Size3(1, 1, 1), Size3(3, 5, 7), Size3(33, 3, 4), Size3(5, 32, 7), Size3(4, 33, 9)})
        for (const int groups : {1, 4})
            for (const double painted : {0.4, 1.0})
                check_surfaces(noise(random, size, painted, groups), {0.5, 0.75, 2});
}

TEST_CASE("voxels of a group that touch only over an edge or a corner are separate surfaces")
{
    const auto vertices = [](const Size3& second) {
        DenseGroups dense = empty_groups({4, 4, 4});
        dense.at({1, 1, 1}) = dense.at(second) = 3;
        const Mask mask = mask_of(dense);
        GroupSurfaces surfaces(mask, {});
        return std::pair(surfaces.size_of(3).vertices, euler_characteristic(mesh_of(surfaces, 3)));
    };
    CHECK(vertices({2, 1, 1}) == std::pair<uint64_t, int64_t>(12, 2));
    // Two cubes, and on each side of the edge the middles of it and of two faces.
    CHECK(vertices({2, 2, 1}) == std::pair<uint64_t, int64_t>(16 + 2 * 3, 4));
    CHECK(vertices({2, 2, 2}) == std::pair<uint64_t, int64_t>(16, 4));
}

TEST_CASE("a smoothed ball of two groups has nearly the area of a sphere, and keeps its volume")
{
    const glm::dvec3 spacing(0.5, 0.5, 1.0);
    const double radius = 6.0;
    const DenseGroups dense = ball({40, 40, 21}, {10.1, 10.0, 10.3}, radius, spacing);
    const Mask mask = mask_of(dense);
    const double sphere = 4.0 * std::numbers::pi * radius * radius, disc = std::numbers::pi * radius * radius;
    const auto area = [&](int steps) {
        GroupSurfaces surfaces(mask, {.steps = steps, .spacing = spacing});
        double sum = 0.0;
        for (const uint8_t group : {uint8_t{1}, uint8_t{2}}) {
            TestMesh mesh = mesh_of(surfaces, group);
            for (glm::dvec3& vertex : mesh.vertices) vertex *= spacing;
            const double voxels = double(mask.voxels_by_group()[group]) * spacing.x * spacing.y * spacing.z;
            CHECK(mesh.volume() == doctest::Approx(voxels).epsilon(0.01));
            sum += mesh.area();
        }
        return sum;
    };
    CHECK(area(0) > 1.4 * sphere + 2.0 * disc);
    CHECK(area(20) == doctest::Approx(sphere + 2.0 * disc).epsilon(0.04));
}

TEST_CASE("surfaces cost the painted bricks, and memory is compared with the budget before")
{
    Mask mask({1 << 15, 1 << 15, 1 << 15});
    const size_t voxel = index_in_brick({9, 9, 9});
    mask.apply({.brick = 12345678, .runs = {{uint16_t(voxel), uint16_t(voxel), 0, 4}}}, Direction::forwards);
    GroupSurfaces surfaces(mask, {.steps = 20});
    CHECK(surfaces.cells() == 1);
    CHECK(surfaces.points() == 8);
    CHECK(surfaces.size_of(4) == GroupSurfaces::Size{8, 12});
    CHECK(surfaces.size_of(5) == GroupSurfaces::Size{});
    const auto refusal = [&](uint64_t memory) -> std::string {
        try {
            GroupSurfaces(mask, {.memory = memory});
        } catch (const Error& error) {
            return error.what();
        }
        return {};
    };
    CHECK(refusal(uint64_t{1} << 20).empty());
    CHECK(refusal(40000) ==
          "the surfaces take 1 MiB of memory; expected at most 0 MiB, the budget of the host: use a larger "
          "--budget-host");
}

TEST_CASE("progress can end surfaces at every step")
{
    std::mt19937 random(9);
    const Mask mask = mask_of(noise(random, {34, 33, 3}, 0.5, 2));
    int64_t steps = 0;
    const GroupSurfaces counted(mask, {.steps = 3, .progress = [&](double fraction) {
                                           CHECK(fraction >= 0.0);
                                           CHECK(fraction <= 1.0);
                                           ++steps;
                                       }});
    REQUIRE(steps > 20);
    for (int64_t stop = 0; stop < steps; stop += 9) {
        int64_t step = 0;
        CHECK_THROWS_AS(GroupSurfaces(mask, {.steps = 3,
                                             .progress =
                                                 [&](double) {
                                                     if (step++ == stop) throw Stopped("stopped");
                                                 }}),
                        Stopped);
    }
}
