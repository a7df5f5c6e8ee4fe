#pragma once
// Where the points of a mesh's file lie in a volume. Any thread.

#include <string>

#include "engine/annotation/trace/trace_space.h"
#include "engine/formats/meshes/mesh_file.h"
#include "engine/look/surfaces/mesh_tree.h"

namespace shvr {

class MeshPlace {
public:
    MeshPlace(const TriangleMesh& mesh, const VolumeInfo& volume);

    /// Position in the volume's space, in its unit.
    glm::dvec3 in_volume(const glm::vec3& point) const;
    /// A sentence with both boxes if no part of the mesh can be in the volume; otherwise empty. The mesh has a point.
    std::string why_unseen(const MeshShape& shape) const;

private:
    /// The position as texts state it: in physical space, or from the volume's corner.
    glm::dvec3 stated(const glm::dvec3& in_volume) const;

    TraceSpace space_;
    glm::dvec3 scale_{1.0};  ///< from the file's unit to the volume's; negative where RAS becomes LPS
    bool is_physical_ = true;
};

}  // namespace shvr
