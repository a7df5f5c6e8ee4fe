#pragma once
// Exact thinning of a set of voxels to lines of the same topology. Voxels of the set are connected over faces, edges
// and corners (26), other voxels over faces (6). Only simple points are removed, one at a time: around a simple point,
// the set's voxels are connected, and the other voxels at its faces are connected within its 18 neighbours over faces
// and edges (Bertrand and Malandain 1994). Layers of growing distance from the outside go first (Pudney 1998), each in
// turns of six directions (Palagyi and Kuba 1998), so lines end up in the middle. Voxels with one neighbour stay.
// From one direction, voxels are removed by the parities of x, y and z, so that those removed one after another do not
// touch (Bertrand and Aktouf 1994): in the order of their indices, a line two voxels wide would go as a whole.
//
// The order depends only on the set. One thread. Takes four times 4 KiB per brick, and up to 16 bytes per voxel of a
// layer.

#include <functional>

#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

/// Whether removing the middle voxel keeps the topology. Bit x + 3 y + 9 z of `around`: whether the set has that voxel.
bool is_simple_point(uint32_t around);

/// Uses the grid of `reach`, but not its distance. Fill the set's cavities first: they would stay as closed surfaces.
/// Calls `takes(bytes)` before it allocates memory; `takes` may refuse by throwing.
BrickSet thinned(const BrickSet& set, const Reach& reach, const std::function<void(uint64_t)>& takes,
                 const Progress& progress);

}  // namespace shvr
