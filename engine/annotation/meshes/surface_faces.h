#pragma once
// The faces between voxels of different groups, and their triangles. A face has four corners; an edge that is split
// (surface_points.h) adds a vertex in its middle, and the face then gets one in its own middle, too. The groups
// on both sides of a face have the same triangles there, in opposite directions. Any thread.

#include <vector>

#include "engine/annotation/meshes/surface_points.h"

namespace shvr {

/// A face across `axis`. The next axes, in the order x, y, z, x, y, are u and v; corners go counter-clockwise seen from
/// above: lower corner, that along u, the opposite one, that along v.
struct SurfaceFace {
    /// The edges, each from a corner to the one after it.
    static constexpr int EDGES = 4;
    /// Vertices: 0 ... 3 corners, 4 ... 7 middles of edges, 8 middle of the face.
    static constexpr int FIRST_MIDDLE = 4, CENTRE = 8;

    int axis = 0;
    glm::ivec3 lower_corner{0};    ///< in its cell
    uint8_t below = 0, above = 0;  ///< the groups on both sides
    uint8_t splits = 0;            ///< bit i: edge i is split
    std::array<uint32_t, EDGES> points{};
    std::array<glm::dvec3, 9> at{};  ///< positions of all vertices, also of those that it lacks; in voxels

    glm::ivec3 corner(int i) const;
    /// The corner from which edge i leads upwards, and its axis.
    std::pair<int, int> edge(int i) const;
};

struct FaceTriangles {
    int count = 0;
    std::array<std::array<uint8_t, 3>, 8> vertices{};  ///< counter-clockwise seen from above
};
/// A face without split edges is cut along its shorter diagonal.
FaceTriangles triangles_of(const SurfaceFace& face, const glm::dvec3& spacing);

using SurfaceOffsets = std::vector<glm::vec3>;  ///< how far each point is from its corner, in voxels
/// The position of a point, in voxels from the outer corner of voxel 0.
inline glm::dvec3 position_of(const SurfaceCell& cell, const glm::ivec3& corner, const glm::vec3& offset)
{
    return glm::dvec3(cell.place * BRICK_SIDE + Size3(corner)) + glm::dvec3(offset);
}

SurfaceFace face_of(const SurfacePoints& points, const CellView& view, const SurfaceOffsets& offsets,
                    const glm::ivec3& lower_corner, int axis);
/// Calls `visit(face)` for each face whose lower corner is in the cell.
template <class Visit>
void for_each_face(const SurfacePoints& points, const CellView& view, const SurfaceOffsets& offsets, const Visit& visit)
{
    view.for_each_point([&](const glm::ivec3& corner, uint32_t) {
        for (int axis = 0; axis < 3; ++axis) {
            glm::ivec3 below = corner;
            --below[axis];
            if (view.group(corner) != view.group(below)) visit(face_of(points, view, offsets, corner, axis));
        }
    });
}

}  // namespace shvr
