#pragma once
// What a mesh must hold to be drawn, and the memory that this takes. Any thread.

#include "engine/look/surfaces/mesh_tree.h"

namespace shvr {

/// Fails, naming the mesh, if a corner is further away than surfaces may be (surface_tree.h), or not finite.
void check_places(const MeshShape& mesh, const VolumeInfo& volume);

/// What mesh_tree() takes for a triangle while it works, with its result.
inline constexpr uint64_t TREE_BYTES_PER_TRIANGLE = 250;

}  // namespace shvr
