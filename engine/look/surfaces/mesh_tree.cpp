#include "engine/look/surfaces/mesh_tree.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/packing.hpp>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/look/surfaces/box_tree.h"
#include "engine/look/surfaces/corner_normals.h"
#include "engine/look/surfaces/mesh_limits.h"
#include "engine/look/surfaces/surface_tree.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

constexpr double MAX_COORDINATE = 2.0 * double(MAX_SIDE);

/// Octahedral encoding of a unit vector (Cigolle and others 2014), in 16 bits for each of two coordinates.
uint32_t packed_normal(const glm::dvec3& normal)
{
    const double sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    glm::dvec2 at = glm::dvec2(normal) / sum;
    if (normal.z < 0.0)
        at = {(1.0 - std::abs(at.y)) * (at.x < 0.0 ? -1.0 : 1.0), (1.0 - std::abs(at.x)) * (at.y < 0.0 ? -1.0 : 1.0)};
    return glm::packSnorm2x16(glm::vec2(at));
}

/// Adds the triangles of a mesh that have an area.
void add(const MeshShape& mesh, double reference_length, std::vector<gpu::Triangle>& list)
{
    const CornerNormals normals(mesh);
    size_t color = 0;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        while (color + 1 < mesh.colors.size() && i >= mesh.color_ends[color]) ++color;
        if (!normals.has_area(i)) continue;
        const glm::uvec3& corners = mesh.triangles[i];
        list.push_back({.a = glm::vec3(mesh.points[corners.x] / reference_length),
                        .number = uint32_t(list.size()),
                        .b = glm::vec3(mesh.points[corners.y] / reference_length),
                        .normal_a = packed_normal(normals.at(i, 0)),
                        .c = glm::vec3(mesh.points[corners.z] / reference_length),
                        .normal_b = packed_normal(normals.at(i, 1)),
                        .color = glm::vec3(mesh.colors[color]),
                        .normal_c = packed_normal(normals.at(i, 2))});
    }
}

}  // namespace

void check_places(const MeshShape& mesh, const VolumeInfo& volume)
{
    const double most = MAX_COORDINATE * reference_length_of(volume);
    for (const glm::dvec3& point : mesh.points)
        if (!is_finite(point) || glm::any(glm::greaterThan(glm::abs(point), glm::dvec3(most))))
            fail(mesh.name, ": a corner is at (", point.x, ", ", point.y, ", ", point.z,
                 ") in the volume's lengths; expected at most ", most,
                 " from its corner along each axis, so unit or place of the mesh are others");
}

MeshTree mesh_tree(std::span<const MeshShape> meshes, const VolumeInfo& volume)
{
    size_t count = 0;
    for (const MeshShape& mesh : meshes) count += mesh.triangles.size();
    if (count > MAX_TRIANGLES_SHOWN)
        fail("the meshes have ", count, " triangles; expected at most ", MAX_TRIANGLES_SHOWN,
             " together, so decimate or hide some");
    const double reference_length = reference_length_of(volume);
    MeshTree tree;
    std::vector<gpu::Triangle> all;
    all.reserve(count);
    for (const MeshShape& mesh : meshes) {
        check_places(mesh, volume);
        add(mesh, reference_length, all);
    }
    std::vector<BoxedSurface> items;
    items.reserve(all.size());
    for (const gpu::Triangle& triangle : all) {
        SurfaceBox box;
        for (const glm::vec3& corner : {triangle.a, triangle.b, triangle.c}) box.add(corner, corner);
        items.push_back({box, 0.5 * (box.lower + box.upper), uint32_t(items.size())});
    }
    tree.nodes = box_tree(items, gpu::SURFACES_IN_LEAF);
    tree.list.reserve(all.size());
    for (const BoxedSurface& item : items) tree.list.push_back(all[item.surface]);
    return tree;
}

}  // namespace shvr
