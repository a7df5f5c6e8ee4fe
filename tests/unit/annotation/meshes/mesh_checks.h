#pragma once
// What a surface must be, checked on its triangles and on a dense array of voxels; shares no code with
// engine/annotation/meshes.

#include <algorithm>
#include <map>

#include <doctest/doctest.h>

#include "engine/annotation/meshes/group_surfaces.h"
#include "tests/unit/annotation/operations/operation_cases.h"

namespace shvr::test {

using Corners = std::array<std::array<double, 3>, 3>;

struct TestMesh {
    std::vector<glm::dvec3> vertices;
    std::vector<glm::uvec3> triangles;

    Corners corners(const glm::uvec3& triangle) const
    {
        Corners found{};
        for (int i = 0; i < 3; ++i)
            for (int axis = 0; axis < 3; ++axis) found[size_t(i)][size_t(axis)] = vertices[triangle[i]][axis];
        return found;
    }
    double volume() const
    {
        double sum = 0.0;
        for (const glm::uvec3& t : triangles)
            sum += glm::dot(vertices[t.x], glm::cross(vertices[t.y], vertices[t.z])) / 6.0;
        return sum;
    }
    double area() const
    {
        double sum = 0.0;
        for (const glm::uvec3& t : triangles)
            sum += glm::length(glm::cross(vertices[t.y] - vertices[t.x], vertices[t.z] - vertices[t.x])) / 2.0;
        return sum;
    }
};

/// `surfaces`: GroupSurfaces or DecimatedSurfaces.
template <class Surfaces>
TestMesh mesh_of(Surfaces& surfaces, uint8_t group)
{
    TestMesh mesh;
    surfaces.for_each_vertex(group, [&](const glm::dvec3& position) { mesh.vertices.push_back(position); });
    bool agree = true;
    surfaces.for_each_triangle(group, [&](const glm::uvec3& indices, const std::array<glm::dvec3, 3>& positions) {
        for (int i = 0; i < 3; ++i)
            agree = agree && indices[i] < mesh.vertices.size() && mesh.vertices[indices[i]] == positions[size_t(i)];
        mesh.triangles.push_back(indices);
    });
    REQUIRE(agree);
    CHECK(GroupSurfaces::Size{mesh.vertices.size(), mesh.triangles.size()} == surfaces.size_of(group));
    return mesh;
}

/// Each edge is in two triangles, once in each direction; the triangles at each vertex are one ring; no two triangles
/// have the same vertices.
inline void check_closed_manifold(const TestMesh& mesh)
{
    std::vector<std::array<uint32_t, 3>> triangles;
    for (const glm::uvec3& t : mesh.triangles) {
        std::ranges::sort(triangles.emplace_back(std::array{t.x, t.y, t.z}));
    }
    std::ranges::sort(triangles);
    CHECK(std::ranges::adjacent_find(triangles) == triangles.end());
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    std::vector<std::array<uint32_t, 3>> around;  // vertex, from, to: the opposite edge of each triangle at it
    for (const glm::uvec3& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            edges.emplace_back(t[i], t[(i + 1) % 3]);
            around.push_back({t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
        }
    std::ranges::sort(edges);
    CHECK(std::ranges::adjacent_find(edges) == edges.end());
    CHECK(std::ranges::all_of(edges, [&](const auto& edge) {
        return edge.first != edge.second && std::ranges::binary_search(edges, std::pair(edge.second, edge.first));
    }));
    std::ranges::sort(around);
    size_t rings = 0, used = 0;
    for (size_t at = 0; at < around.size(); ++used) {
        std::map<uint32_t, uint32_t> next;
        const uint32_t vertex = around[at][0];
        for (; at < around.size() && around[at][0] == vertex; ++at) next[around[at][1]] = around[at][2];
        size_t steps = 1;
        const uint32_t first = next.begin()->first;
        for (uint32_t here = next[first]; here != first && next.contains(here) && steps <= next.size();
             here = next[here])
            ++steps;
        rings += size_t(steps == next.size());
    }
    CHECK(used == mesh.vertices.size());
    CHECK(rings == used);
}

inline int64_t euler_characteristic(const TestMesh& mesh)
{
    return int64_t(mesh.vertices.size()) + int64_t(mesh.triangles.size()) - int64_t(mesh.triangles.size()) * 3 / 2;
}

inline uint8_t group_at(const DenseGroups& dense, const Size3& voxel)
{
    return dense.contains(voxel) ? dense.at(voxel) : uint8_t{0};
}

/// That of the boundary of the group's voxels, joined over faces, where voxels that meet over an edge or a corner only
/// are separate, and so are two unpainted voxels that meet over a corner only: twice voxels - shared faces + edges that
/// are inside - corners that are inside, and two more for each such corner.
inline int64_t expected_euler_characteristic(const DenseGroups& dense, uint8_t group)
{
    int64_t solid = 0, split_corners = 0;
    reference::for_each_voxel(dense.size + int64_t{1}, [&](const Size3& corner) {
        std::array<bool, 8> holds{};
        for (size_t i = 0; i < 8; ++i)
            holds[i] = group_at(dense, corner - Size3(i & 1, i >> 1 & 1, i >> 2 & 1)) == group;
        const auto all = [&](std::initializer_list<size_t> which) {
            return std::ranges::all_of(which, [&](size_t i) { return holds[i]; });
        };
        solid += int64_t(holds[0]) - all({0, 1}) - all({0, 2}) - all({0, 4}) + all({0, 1, 2, 3}) + all({0, 1, 4, 5}) +
                 all({0, 2, 4, 6}) - all({0, 1, 2, 3, 4, 5, 6, 7});
        for (size_t i = 0; i < 4; ++i)
            split_corners += int64_t(!holds[i] && !holds[7 - i] && std::ranges::count(holds, false) == 2);
    });
    return 2 * solid + 2 * split_corners;
}

/// Triangles of unsmoothed surfaces have a voxel of the group on their inner side and another one outside.
inline void check_sides(const TestMesh& mesh, const DenseGroups& dense, uint8_t group)
{
    int64_t wrong = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = mesh.vertices[t.x], b = mesh.vertices[t.y], c = mesh.vertices[t.z];
        const glm::dvec3 middle = (a + b + c) / 3.0, normal = glm::normalize(glm::cross(b - a, c - a));
        wrong += int64_t(group_at(dense, Size3(glm::floor(middle - 0.25 * normal))) != group);
        wrong += int64_t(group_at(dense, Size3(glm::floor(middle + 0.25 * normal))) == group);
    }
    CHECK(wrong == 0);
}

/// The triangle beginning at its smallest corner.
inline Corners rotated(Corners corners)
{
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    return corners;
}

/// Number of triangles that two meshes share: the same corners in opposite directions.
inline size_t shared_triangles(const TestMesh& a, const TestMesh& b)
{
    std::vector<Corners> of_a, of_b, both;
    for (const glm::uvec3& t : a.triangles) of_a.push_back(rotated(a.corners(t)));
    for (const glm::uvec3& t : b.triangles) of_b.push_back(rotated(b.corners({t.x, t.z, t.y})));
    std::ranges::sort(of_a);
    std::ranges::sort(of_b);
    std::ranges::set_intersection(of_a, of_b, std::back_inserter(both));
    return both.size();
}

}  // namespace shvr::test
