#pragma once
// How the surface of a group runs around one corner of the voxel grid. Pure functions; any thread.
//
// The eight voxels around a corner are its octants: bit 0, 1 and 2 of an octant's number are set on the upper side
// along x, y and z. The faces between voxels of the group and others are glued along the edges that they share. Where
// four of them share an edge, because two voxels of the group are diagonal neighbours there, the two faces of each
// voxel are glued: the voxels are separate. So a corner has one or more sheets, each a closed ring of faces, and the
// group gets a vertex for each sheet. All of them lie at the same position.

#include <array>
#include <cstdint>

namespace shvr {

/// The number of a face between two octants that differ along `axis`; `octant` is either of the two.
inline int face_at_corner(int octant, int axis)
{
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    return 4 * axis + (octant >> next & 1) + 2 * (octant >> last & 1);
}
inline constexpr int FACES_AT_CORNER = 12;

struct CornerSheets {
    uint8_t count = 0;
    std::array<uint8_t, FACES_AT_CORNER>
        of_face{};  ///< the sheet of each face; 0 for faces that are not on the surface
};
/// `octants`: bit i is set if octant i belongs to the group.
const CornerSheets& sheets_at_corner(uint8_t octants);

/// The four voxels around the edge that leads from a corner upwards along `axis`, as bits: bit 0 of a bit's number is
/// the side along the next axis, bit 1 the side along the last one. `octants` as above.
uint8_t quadrants_of(uint8_t octants, int axis);
/// Whether the bits are two voxels that are diagonal neighbours.
inline bool is_diagonal(uint8_t quadrants)
{
    return quadrants == 0b1001 || quadrants == 0b0110;
}

}  // namespace shvr
