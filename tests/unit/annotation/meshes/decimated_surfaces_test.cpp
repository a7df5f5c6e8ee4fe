// Surfaces with fewer triangles: still closed manifolds with equal borders, volumes and topology, within the error.

#include <cmath>
#include <set>

#include "engine/annotation/meshes/decimated_surfaces.h"
#include "tests/unit/annotation/meshes/mesh_checks.h"

using namespace shvr;
using namespace shvr::test;

namespace {

struct Decimated {
    std::map<uint8_t, TestMesh> before, after;
    double error = 0.0;
};

Decimated decimated(const DenseGroups& dense, const glm::dvec3& spacing, int steps, double share)
{
    const Mask mask = mask_of(dense);
    GroupSurfaces surfaces(mask, {.steps = steps, .spacing = spacing});
    DecimatedSurfaces coarse(surfaces, {.share = share, .spacing = spacing});
    Decimated meshes;
    meshes.error = coarse.error();
    for (int group = 1; group < 256; ++group) {
        CHECK((mask.voxels_by_group()[size_t(group)] == 0) == (coarse.size_of(uint8_t(group)).triangles == 0));
        if (mask.voxels_by_group()[size_t(group)] == 0) continue;
        meshes.before[uint8_t(group)] = mesh_of(surfaces, uint8_t(group));
        meshes.after[uint8_t(group)] = mesh_of(coarse, uint8_t(group));
    }
    return meshes;
}

/// The distance of a point from a triangle, by its plane if the foot lies inside, and else by its sides.
double distance_from(const glm::dvec3& point, const std::array<glm::dvec3, 3>& corners)
{
    double least = 1e300;
    for (size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &a = corners[i], side = corners[(i + 1) % 3] - a;
        const double along = std::clamp(glm::dot(point - a, side) / glm::dot(side, side), 0.0, 1.0);
        least = std::min(least, glm::distance(point, a + along * side));
    }
    const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const double height = glm::dot(point - corners[0], normal);
    bool is_inside = true;
    for (size_t i = 0; i < 3; ++i)
        is_inside =
            is_inside && glm::dot(glm::cross(corners[(i + 1) % 3] - corners[i], point - corners[i]), normal) >= 0;
    return is_inside ? std::min(least, std::abs(height)) : least;
}

/// How many of the points are farther than `limit` from the mesh.
size_t count_beyond(const TestMesh& mesh, const std::vector<glm::dvec3>& points, const glm::dvec3& spacing,
                    double limit)
{
    struct Triangle {
        std::array<glm::dvec3, 3> corners;
        double radius = 0.0;  // around the first corner
    };
    std::vector<Triangle> triangles;
    for (const glm::uvec3& t : mesh.triangles) {
        const std::array corners{mesh.vertices[t.x] * spacing, mesh.vertices[t.y] * spacing,
                                 mesh.vertices[t.z] * spacing};
        const double radius = std::max(glm::distance(corners[0], corners[1]), glm::distance(corners[0], corners[2]));
        triangles.push_back({corners, radius});
    }
    size_t beyond = 0, last = 0;
    for (const glm::dvec3& point : points) {
        const auto is_near = [&](const Triangle& triangle) {
            const double reach = triangle.radius + limit;
            const glm::dvec3 to = point - triangle.corners[0];
            return glm::dot(to, to) <= reach * reach && distance_from(point, triangle.corners) <= limit;
        };
        if (is_near(triangles[last])) continue;
        const auto found = std::ranges::find_if(triangles, is_near);
        if (found == triangles.end())
            ++beyond;
        else
            last = size_t(found - triangles.begin());
    }
    return beyond;
}

/// In both directions; of the coarse surface, points all over its triangles.
void check_error(const Decimated& meshes, const glm::dvec3& spacing)
{
    CHECK(meshes.error <= std::min({spacing.x, spacing.y, spacing.z}));
    const double limit = meshes.error + 1e-9;
    for (const auto& [group, before] : meshes.before) {
        const TestMesh& after = meshes.after.at(group);
        std::vector<glm::dvec3> full, coarse;
        for (const glm::dvec3& vertex : before.vertices) full.push_back(vertex * spacing);
        for (const glm::dvec3& vertex : after.vertices) coarse.push_back(vertex * spacing);
        constexpr int PARTS = 3;
        for (const glm::uvec3& t : after.triangles)
            for (int i = 0; i <= PARTS; ++i)
                for (int k = i == 0 ? 1 : 0; i + k < (i == 0 ? PARTS : PARTS + 1); ++k)
                    coarse.push_back((double(i) * after.vertices[t.x] + double(k) * after.vertices[t.y] +
                                      double(PARTS - i - k) * after.vertices[t.z]) /
                                     double(PARTS) * spacing);
        CHECK(count_beyond(after, full, spacing, limit) == 0);
        CHECK(count_beyond(before, coarse, spacing, limit) == 0);
    }
}

void check_meshes(const Decimated& meshes, const DenseGroups& dense, const glm::dvec3& spacing)
{
    for (const auto& [group, mesh] : meshes.after) {
        CAPTURE(int(group));
        check_closed_manifold(mesh);
        CHECK(euler_characteristic(mesh) == euler_characteristic(meshes.before.at(group)));
        CHECK(mesh.volume() == doctest::Approx(double(std::ranges::count(dense.groups, group))).epsilon(0.01));
        CHECK(mesh.triangles.size() <= meshes.before.at(group).triangles.size());
        for (const auto& [other, of_other] : meshes.after)
            if (other > group)
                CHECK((shared_triangles(mesh, of_other) == 0) ==
                      (shared_triangles(meshes.before.at(group), meshes.before.at(other)) == 0));
    }
    check_error(meshes, spacing);
}

/// Two halves of a ball, of groups 1 and 2.
DenseGroups ball(const Size3& size, const glm::dvec3& centre, double radius, const glm::dvec3& spacing)
{
    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
    reference::for_each_voxel(size, [&](const Size3& voxel) {
        const glm::dvec3 from = spacing * (glm::dvec3(voxel) + 0.5) - centre;
        if (glm::length(from) <= radius) dense.at(voxel) = from.x < 0.0 ? 1 : 2;
    });
    return dense;
}

/// Each voxel belongs to the largest of some smooth random fields, the first of which is that of unpainted voxels.
DenseGroups blobs(const Size3& size, int groups, bool has_unpainted, uint32_t seed)
{
    std::mt19937 random(seed);
    struct Wave {
        glm::dvec3 frequency;
        double phase;
    };
    std::vector<std::array<Wave, 6>> fields{size_t(groups)};
    const auto uniform = [&] { return double(random() % 10000) / 10000.0; };
    for (std::array<Wave, 6>& field : fields)
        for (Wave& wave : field) wave = {{uniform() - 0.5, uniform() - 0.5, uniform() - 0.5}, 6.3 * uniform()};
    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
    reference::for_each_voxel(size, [&](const Size3& voxel) {
        double largest = -1e300;
        for (size_t i = 0; i < fields.size(); ++i) {
            double value = 0.0;
            for (const Wave& wave : fields[i])
                value += std::sin(glm::dot(wave.frequency, glm::dvec3(voxel)) + wave.phase);
            if (value <= largest) continue;
            largest = value;
            dense.at(voxel) = uint8_t(i + (has_unpainted ? 0 : 1));
        }
    });
    return dense;
}

}  // namespace

TEST_CASE("a decimated ball of two groups has a third of the triangles, its volumes and its border")
{
    const glm::dvec3 spacing(0.5, 0.5, 1.0);
    const DenseGroups dense = ball({32, 32, 17}, {8.1, 8.0, 8.3}, 6.0, spacing);
    for (const int steps : {0, 20}) {
        const Decimated meshes = decimated(dense, spacing, steps, 0.2);
        check_meshes(meshes, dense, spacing);
        CHECK(meshes.error < (steps == 0 ? 1.0 : 0.5));
        CHECK(meshes.error > 0.0);
        const size_t before = shared_triangles(meshes.before.at(1), meshes.before.at(2)),
                     after = shared_triangles(meshes.after.at(1), meshes.after.at(2));
        // The border is a disc, whose outline stays.
        CHECK(after < before / 3);
        CHECK(after > 30);
        for (const auto& [group, mesh] : meshes.after)
            CHECK(3 * mesh.triangles.size() < meshes.before.at(group).triangles.size());
    }
}

// Kind (operations on groups): decimated surfaces of noise, where most vertices lie on borders of three groups
TEST_CASE("decimated surfaces of noise are closed manifolds that share borders")
{
    std::mt19937 random(11);
    for (const Size3& size : {Size3(1, 1, 1), Size3(3, 5, 7), Size3(33, 3, 4), Size3(7, 8, 9)})
        for (const int groups : {1, 3})
            for (const double painted : {0.4, 0.8, 1.0})
                for (const int steps : {0, 10}) {
                    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
                    for (uint8_t& group : dense.groups)
                        if (double(random() % 1000) < 1000.0 * painted)
                            group = uint8_t(1 + int(random() % uint32_t(groups)));
                    if (std::ranges::count(dense.groups, 0) == std::ssize(dense.groups)) continue;
                    CAPTURE(size.x);
                    CAPTURE(groups);
                    CAPTURE(painted);
                    CAPTURE(steps);
                    check_meshes(decimated(dense, {0.5, 0.75, 2}, steps, 0.05), dense, {0.5, 0.75, 2});
                }
}

// Kind (operations on groups): decimated surfaces of blobs that touch, with lines where three groups meet
TEST_CASE("decimated surfaces of blobs that touch are closed manifolds within the error in both directions")
{
    for (uint32_t seed = 0; seed < 4; ++seed)
        for (const int steps : {0, 20}) {
            const glm::dvec3 spacing = seed % 2 == 0 ? glm::dvec3(1, 1, 1) : glm::dvec3(1, 1, 5);
            const DenseGroups dense = blobs({18, 17, 16}, 3, seed < 2, seed);
            CAPTURE(seed);
            CAPTURE(steps);
            check_meshes(decimated(dense, spacing, steps, 0.05), dense, spacing);
        }
}

TEST_CASE("no triangle of a border between groups is left on one side alone")
{
    // All voxels of a block are painted, in layers of groups with wavy borders: what is not shared lies at its outside.
    const Size3 size(14, 12, 13);
    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
    reference::for_each_voxel(size, [&](const Size3& voxel) {
        const double height = double(voxel.z) + 1.5 * std::sin(0.7 * double(voxel.x)) + std::cos(0.5 * double(voxel.y));
        dense.at(voxel) = height < 4.0 ? 1 : height < 8.5 ? 2 : 3;
    });
    const Decimated meshes = decimated(dense, {1, 1, 1}, 20, 0.1);
    check_meshes(meshes, dense, {1, 1, 1});
    std::map<Corners, int> sides;
    size_t all = 0;
    for (const auto& [group, mesh] : meshes.after)
        for (const glm::uvec3& t : mesh.triangles) {
            ++sides[rotated(mesh.corners(t))];
            --sides[rotated(mesh.corners({t.x, t.z, t.y}))];
            ++all;
        }
    size_t alone = 0, inside = 0;
    for (const auto& [corners, count] : sides) {
        if (count <= 0) continue;
        ++alone;
        bool is_outside = false;
        for (size_t axis = 0; axis < 3; ++axis) {
            const double middle = (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3.0;
            is_outside = is_outside || middle < 0.8 || middle > double(size[int(axis)]) - 0.8;
        }
        inside += size_t(!is_outside);
    }
    CHECK(inside == 0);
    CHECK(alone < all);
    CHECK(alone > 50);
}

TEST_CASE("decimation is compared with the budget before, and progress can end it")
{
    const DenseGroups dense = ball({20, 20, 20}, {10, 10, 10}, 8.0, {1, 1, 1});
    const Mask mask = mask_of(dense);
    GroupSurfaces surfaces(mask, {.steps = 5});
    CHECK_THROWS_WITH_AS(
        DecimatedSurfaces(surfaces, {.share = 0.5, .memory = uint64_t{1} << 20}),
        doctest::Contains("MiB of memory to be decimated; expected at most 1 MiB, the budget of the host"), Error);
    int64_t steps = 0;
    const DecimatedSurfaces counted(surfaces, {.share = 0.5, .progress = [&](double fraction) {
                                                   CHECK(fraction >= 0.0);
                                                   CHECK(fraction <= 1.0);
                                                   ++steps;
                                               }});
    for (int64_t stop = 0; stop < steps; stop += 5) {
        int64_t step = 0;
        CHECK_THROWS_AS(DecimatedSurfaces(surfaces, {.share = 0.5,
                                                     .progress =
                                                         [&](double) {
                                                             if (step++ == stop) throw Stopped("stopped");
                                                         }}),
                        Stopped);
    }
}
