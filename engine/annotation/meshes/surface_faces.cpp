#include "engine/annotation/meshes/surface_faces.h"

#include <bit>

namespace shvr {

glm::ivec3 SurfaceFace::corner(int i) const
{
    glm::ivec3 corner = lower_corner;
    if (i == 1 || i == 2) ++corner[(axis + 1) % 3];
    if (i >= 2) ++corner[(axis + 2) % 3];
    return corner;
}

std::pair<int, int> SurfaceFace::edge(int i) const
{
    constexpr int FROM[EDGES] = {0, 1, 3, 0};
    return {FROM[i], (axis + (i % 2 == 0 ? 1 : 2)) % 3};
}

FaceTriangles triangles_of(const SurfaceFace& face, const glm::dvec3& spacing)
{
    if (face.splits == 0) {
        const glm::dvec3 a = spacing * (face.at[2] - face.at[0]), b = spacing * (face.at[3] - face.at[1]);
        if (glm::dot(a, a) <= glm::dot(b, b)) return {2, {{{0, 1, 2}, {0, 2, 3}}}};
        return {2, {{{0, 1, 3}, {1, 2, 3}}}};
    }
    FaceTriangles triangles;
    const auto add = [&](int from, int to) {
        triangles.vertices[size_t(triangles.count++)] = {uint8_t(from), uint8_t(to), SurfaceFace::CENTRE};
    };
    for (int i = 0; i < SurfaceFace::EDGES; ++i) {
        const int next = (i + 1) % SurfaceFace::EDGES, middle = SurfaceFace::FIRST_MIDDLE + i;
        if ((face.splits >> i & 1) == 0) {
            add(i, next);
        } else {
            add(i, middle);
            add(middle, next);
        }
    }
    return triangles;
}

SurfaceFace face_of(const SurfacePoints& points, const CellView& view, const SurfaceOffsets& offsets,
                    const glm::ivec3& lower_corner, int axis)
{
    SurfaceFace face{.axis = axis, .lower_corner = lower_corner};
    glm::ivec3 below = lower_corner;
    --below[axis];
    face.below = view.group(below);
    face.above = view.group(lower_corner);
    for (int i = 0; i < SurfaceFace::EDGES; ++i) {
        const uint32_t point = face.points[size_t(i)] = view.point(face.corner(i));
        face.at[size_t(i)] = position_of(view.cell(), face.corner(i), offsets[point]);
    }
    for (int i = 0; i < SurfaceFace::EDGES; ++i) {
        const auto [from, along] = face.edge(i);
        if ((points.marks(face.points[size_t(from)]) >> along & 1) != 0) face.splits = uint8_t(face.splits | 1 << i);
        const size_t next = size_t(i + 1) % SurfaceFace::EDGES;
        face.at[size_t(SurfaceFace::FIRST_MIDDLE + i)] = 0.5 * (face.at[size_t(i)] + face.at[next]);
    }
    face.at[SurfaceFace::CENTRE] = 0.25 * ((face.at[0] + face.at[2]) + (face.at[1] + face.at[3]));
    return face;
}

}  // namespace shvr
