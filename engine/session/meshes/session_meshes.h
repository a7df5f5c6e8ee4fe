#pragma once
// Reads the meshes that a session shows, into the volume's space. Any thread.

#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/look/surfaces/mesh_tree.h"
#include "engine/session/session.h"

namespace shvr {

struct ReadMeshes {
    MeshTree tree;                      ///< triangles of the meshes that are shown and could be read
    std::vector<std::string> failures;  ///< one sentence for each that could not be read
};
/// Reads the meshes that are shown. Positions are those of the volume's physical space, in its unit, unless a file
/// states that they start at the volume's corner, or another unit. `memory`: bytes that it may take.
ReadMeshes read_meshes(const Session& session, const VolumeInfo& volume, uint64_t memory, const Progress& progress);

}  // namespace shvr
