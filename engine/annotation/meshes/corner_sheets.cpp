#include "engine/annotation/meshes/corner_sheets.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace shvr {

namespace {

using Roots = std::array<int, FACES_AT_CORNER>;

int root_of(const Roots& roots, int face)
{
    while (roots[size_t(face)] != face) face = roots[size_t(face)];
    return face;
}

void glue(Roots& roots, int a, int b)
{
    roots[size_t(root_of(roots, a))] = root_of(roots, b);
}

/// Glues the faces that share the edge from the corner along `axis`, on its side `side`.
void glue_at_edge(uint8_t octants, int axis, int side, Roots& roots)
{
    const auto holds = [&](int octant) { return (octants >> octant & 1) != 0; };
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    std::vector<int> faces;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
        const int octant = side << axis | (quadrant & 1) << next | (quadrant >> 1) << last;
        for (const int across : {next, last})
            if (holds(octant) && !holds(octant ^ 1 << across)) faces.push_back(face_at_corner(octant, across));
    }
    // Of four faces, the first two belong to the first voxel of the group, and the others to the second one.
    for (size_t i = 0; i + 1 < faces.size(); i += 2) glue(roots, faces[i], faces[i + 1]);
}

CornerSheets find_sheets(uint8_t octants)
{
    Roots roots;
    std::iota(roots.begin(), roots.end(), 0);
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) glue_at_edge(octants, axis, side, roots);
    CornerSheets sheets;
    std::vector<int> found;
    for (int octant = 0; octant < 8; ++octant)
        for (int axis = 0; axis < 3; ++axis) {
            if ((octants >> octant & 1) == 0 || (octants >> (octant ^ 1 << axis) & 1) != 0) continue;
            const int face = face_at_corner(octant, axis), root = root_of(roots, face);
            const auto at = std::ranges::find(found, root);
            sheets.of_face[size_t(face)] = uint8_t(at - found.begin());
            if (at == found.end()) found.push_back(root);
        }
    sheets.count = uint8_t(found.size());
    return sheets;
}

}  // namespace

const CornerSheets& sheets_at_corner(uint8_t octants)
{
    static const std::array<CornerSheets, 256> TABLE = [] {
        std::array<CornerSheets, 256> table;
        for (size_t i = 0; i < table.size(); ++i) table[i] = find_sheets(uint8_t(i));
        return table;
    }();
    return TABLE[octants];
}

uint8_t quadrants_of(uint8_t octants, int axis)
{
    uint8_t quadrants = 0;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
        const int octant = 1 << axis | (quadrant & 1) << (axis + 1) % 3 | (quadrant >> 1) << (axis + 2) % 3;
        quadrants = uint8_t(quadrants | (octants >> octant & 1) << quadrant);
    }
    return quadrants;
}

}  // namespace shvr
