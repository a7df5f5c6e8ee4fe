#include "engine/annotation/meshes/group_surfaces.h"

#include <algorithm>

#include "engine/annotation/meshes/corner_sheets.h"
#include "engine/annotation/meshes/surface_smoothing.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

/// The vertices of a group at one point, in order: its sheets, the middles of the split edges upwards along x, y and z,
/// and the middles of the split faces across x, y and z.
struct VerticesAtPoint {
    VerticesAtPoint(const std::array<uint8_t, 8>& octants, uint8_t marks, uint8_t group)
        : bits(bits_of_group(octants, group))
    {
        count = sheets_at_corner(bits).count;
        if (marks == 0) return;
        for (int axis = 0; axis < 3; ++axis) {
            first_middle[size_t(axis)] = count;
            const uint8_t quadrants = quadrants_of(bits, axis);
            if ((marks >> axis & 1) != 0 && quadrants != 0) count += is_diagonal(quadrants) ? 2 : 1;
        }
        for (int axis = 0; axis < 3; ++axis) {
            centre[size_t(axis)] = count;
            // The voxels on both sides of the face are the upper octants along the other two axes.
            const bool is_above = (bits >> 7 & 1) != 0, is_below = (bits >> (7 ^ 1 << axis) & 1) != 0;
            if ((marks >> (3 + axis) & 1) != 0 && is_above != is_below) ++count;
        }
    }

    uint8_t bits;
    uint32_t count = 0;
    std::array<uint32_t, 3> first_middle{}, centre{};
};

/// The octant at corner `i` of a face that is on the group's side of it and holds the face's voxel.
int octant_of(const SurfaceFace& face, int corner, bool is_below)
{
    const int u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;
    const bool is_upper_u = corner == 1 || corner == 2, is_upper_v = corner >= 2;
    return (is_below ? 0 : 1 << face.axis) | (is_upper_u ? 0 : 1 << u) | (is_upper_v ? 0 : 1 << v);
}

}  // namespace

GroupSurfaces::GroupSurfaces(const Mask& mask, const SurfaceOptions& options)
    : points_(mask, options.memory, part_of(options.progress, 0.0, 0.2)),
      spacing_(options.spacing),
      offsets_(smoothed(points_, options.steps, options.spacing, part_of(options.progress, 0.2, 0.9)))
{
    count(part_of(options.progress, 0.9, 1.0));
}

void GroupSurfaces::count(const Progress& progress)
{
    CellView view;
    for (const SurfaceCell& cell : points_.cells()) {
        tell(progress, double(&cell - points_.cells().data()) / double(points_.cells().size()));
        view.load(points_, cell);
        view.for_each_point([&](const glm::ivec3& corner, uint32_t point) {
            const std::array<uint8_t, 8> octants = view.octants(corner);
            for (size_t i = 0; i < octants.size(); ++i)
                if (std::find(octants.begin(), octants.begin() + i, octants[i]) == octants.begin() + i)
                    sizes_[octants[i]].vertices += VerticesAtPoint(octants, points_.marks(point), octants[i]).count;
        });
        for_each_face(points_, view, offsets_, [&](const SurfaceFace& face) {
            const int triangles = face.splits == 0 ? 2 : SurfaceFace::EDGES + std::popcount(face.splits);
            sizes_[face.below].triangles += uint64_t(triangles);
            sizes_[face.above].triangles += uint64_t(triangles);
        });
    }
    sizes_[0] = {};
    for (int group = 1; group < 256; ++group)
        if (sizes_[size_t(group)].vertices >= UINT32_MAX)
            fail("group ", group, ": its surface has ", sizes_[size_t(group)].vertices,
                 " vertices; expected fewer than 4294967295");
}

void GroupSurfaces::number_vertices(uint8_t group)
{
    if (numbered_ == group) return;
    first_vertex_.resize(points_.count());
    uint32_t next = 0;
    CellView view;
    for (const SurfaceCell& cell : points_.cells()) {
        if (!cell.groups[group]) continue;
        view.load(points_, cell);
        view.for_each_point([&](const glm::ivec3& corner, uint32_t point) {
            first_vertex_[point] = next;
            next += VerticesAtPoint(view.octants(corner), points_.marks(point), group).count;
        });
    }
    SHVR_CHECK(next == sizes_[group].vertices, next, ", ", sizes_[group].vertices);
    numbered_ = group;
}

void GroupSurfaces::for_each_vertex(uint8_t group, const VisitVertex& visit, const Progress& progress) const
{
    CellView view;
    for (const SurfaceCell& cell : points_.cells()) {
        tell(progress, double(&cell - points_.cells().data()) / double(points_.cells().size()));
        if (!cell.groups[group]) continue;
        view.load(points_, cell);
        view.for_each_point([&](const glm::ivec3& corner, uint32_t point) {
            const VerticesAtPoint vertices(view.octants(corner), points_.marks(point), group);
            const glm::dvec3 position = position_of(cell, corner, offsets_[point]);
            for (uint32_t i = 0; i < sheets_at_corner(vertices.bits).count; ++i) visit(position);
            for (int axis = 0; axis < 3 && points_.marks(point) != 0; ++axis) {
                const uint32_t middles = (axis < 2 ? vertices.first_middle[size_t(axis) + 1] : vertices.centre[0]) -
                                         vertices.first_middle[size_t(axis)];
                if (middles == 0) continue;
                glm::ivec3 other = corner;
                ++other[axis];
                const glm::dvec3 end = position_of(cell, other, offsets_[view.point(other)]);
                for (uint32_t i = 0; i < middles; ++i) visit(0.5 * (position + end));
            }
            for (int axis = 0; axis < 3 && points_.marks(point) != 0; ++axis)
                if ((axis < 2 ? vertices.centre[size_t(axis) + 1] : vertices.count) != vertices.centre[size_t(axis)])
                    visit(face_of(points_, view, offsets_, corner, axis).at[SurfaceFace::CENTRE]);
        });
    }
}

void GroupSurfaces::for_each_triangle(uint8_t group, const VisitTriangle& visit, const Progress& progress)
{
    visit_triangles(
        group,
        [&](const SurfaceFace& face, const std::array<uint8_t, 3>& corners, const glm::uvec3& indices) {
            visit(indices, {face.at[corners[0]], face.at[corners[1]], face.at[corners[2]]});
        },
        progress);
}

void GroupSurfaces::for_each_border_triangle(uint8_t group, const VisitBorderTriangle& visit, const Progress& progress)
{
    visit_triangles(
        group,
        [&](const SurfaceFace& face, const std::array<uint8_t, 3>&, const glm::uvec3& indices) {
            visit(indices, face.below == group ? face.above : face.below);
        },
        progress);
}

/// `visit(face, corners, indices)`: the triangle's vertices as those of the face and as those of the group.
template <class Visit>
void GroupSurfaces::visit_triangles(uint8_t group, const Visit& visit, const Progress& progress)
{
    number_vertices(group);
    CellView view;
    const auto index_of_vertex = [&](const SurfaceFace& face, bool is_below, int vertex) {
        const auto at = [&](int corner) {
            const uint32_t point = face.points[size_t(corner)];
            return std::pair(first_vertex_[point],
                             VerticesAtPoint(view.octants(face.corner(corner)), points_.marks(point), group));
        };
        if (vertex < SurfaceFace::FIRST_MIDDLE) {
            const auto [first, vertices] = at(vertex);
            const int number = face_at_corner(octant_of(face, vertex, is_below), face.axis);
            return first + sheets_at_corner(vertices.bits).of_face[size_t(number)];
        }
        if (vertex == SurfaceFace::CENTRE) {
            const auto [first, vertices] = at(0);
            return first + vertices.centre[size_t(face.axis)];
        }
        const auto [corner, along] = face.edge(vertex - SurfaceFace::FIRST_MIDDLE);
        const auto [first, vertices] = at(corner);
        const int octant = octant_of(face, corner, is_below);
        const bool is_second = is_diagonal(quadrants_of(vertices.bits, along)) && (octant >> (along + 2) % 3 & 1) != 0;
        return first + vertices.first_middle[size_t(along)] + uint32_t(is_second);
    };
    for (const SurfaceCell& cell : points_.cells()) {
        tell(progress, double(&cell - points_.cells().data()) / double(points_.cells().size()));
        if (!cell.groups[group]) continue;
        view.load(points_, cell);
        for_each_face(points_, view, offsets_, [&](const SurfaceFace& face) {
            if (face.below != group && face.above != group) return;
            const bool is_below = face.below == group;
            const FaceTriangles triangles = triangles_of(face, spacing_);
            for (int i = 0; i < triangles.count; ++i) {
                auto [a, b, c] = triangles.vertices[size_t(i)];
                if (!is_below) std::swap(b, c);  // seen from outside the group
                visit(face, {a, b, c},
                      glm::uvec3(index_of_vertex(face, is_below, a), index_of_vertex(face, is_below, b),
                                 index_of_vertex(face, is_below, c)));
            }
        });
    }
}

}  // namespace shvr
