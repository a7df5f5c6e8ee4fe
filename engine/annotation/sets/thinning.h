#pragma once
// Exact thinning of a set of voxels to lines of the same topology: voxels connected over faces, edges and corners (26),
// the others over faces (6). Only simple points are removed, one after the other; a point is simple if its neighbours
// form one part, and the voxels outside form one part among its 18 neighbours over faces and edges (Bertrand and
// Malandain 1994). Layers of growing distance from the outside go first (Pudney 1998), each in turns of six directions
// (Palagyi and Kuba 1998), so that lines end up in the middle. Voxels with one neighbour stay: they are ends.
//
// The order depends on the set alone. One thread; takes 4 KiB for each brick, four times, and up to 16 bytes for each
// voxel of a layer.

#include <functional>

#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

/// Whether removing the middle voxel keeps the topology. Bit x + 3 y + 9 z of `around`: a voxel of the 3^3 voxels.
bool is_simple_point(uint32_t around);

/// `reach`: the grid; its distance is not used. The set must have no cavities, or keeps them as closed surfaces.
/// `takes(bytes)` is called before memory is taken, and may refuse it by an exception.
BrickSet thinned(const BrickSet& set, const Reach& reach, const std::function<void(uint64_t)>& takes,
                 const Progress& progress);

}  // namespace shvr
