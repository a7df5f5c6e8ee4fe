#pragma once
// Reads the meshes that a session shows, into the volume's space. Any thread.

#include <string>
#include <utility>
#include <vector>

#include "engine/base/progress.h"
#include "engine/look/surfaces/mesh_tree.h"
#include "engine/session/session.h"

namespace shvr {

struct ReadMeshes {
    MeshTree tree;  ///< triangles of the meshes that are shown and could be read
    /// Those that cannot be shown: MeshLook::file, and a sentence.
    std::vector<std::pair<std::string, std::string>> failures;
    std::vector<std::string> warnings;  ///< about those in `tree`: they lie outside the volume
};
/// Reads the meshes that are shown. Positions are those of the volume's physical space, in its unit, unless a file
/// states that they start at the volume's corner, or another unit or frame. `memory`: bytes that all of them may take
/// together; a mesh that exceeds what those before it leave is not shown.
ReadMeshes read_meshes(const Session& session, const VolumeInfo& volume, uint64_t memory, const Progress& progress);

struct MeshCheck {
    size_t triangles = 0;
    std::string warning;  ///< as in ReadMeshes; empty if there is none
};
/// Reads a mesh to its end, and fails where read_meshes() would not show it.
MeshCheck check_mesh(const std::filesystem::path& path, const VolumeInfo& volume, uint64_t memory,
                     const Progress& progress);

}  // namespace shvr
