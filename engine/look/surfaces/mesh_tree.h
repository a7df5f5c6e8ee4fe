#pragma once
// The triangles of meshes as the device searches them: a list, and a hierarchy of boxes around them
// (shaders/surfaces.h). Plain data; any thread.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/volume/volume.h"
#include "shaders/surfaces.h"

namespace shvr {

/// A mesh in the volume's space. Each triangle has its own colour, by `colors` and `color_of`.
struct MeshShape {
    std::string name;                   ///< for messages
    std::vector<glm::dvec3> points;     ///< physical units, from the corner of voxel 0
    std::vector<glm::uvec3> triangles;  ///< counter-clockwise from outside; both sides are drawn
    std::vector<glm::dvec3> colors;     ///< linear light
    std::vector<uint32_t> color_ends;   ///< for each colour, the end of its range of triangles, ascending
};

/// Triangles of all meshes of a scene: their list takes 64 bytes each, their boxes 24 on average.
inline constexpr size_t MAX_TRIANGLES_SHOWN = size_t{1} << 22;

struct MeshTree {
    std::vector<gpu::SurfaceNode> nodes;
    std::vector<gpu::Triangle> list;  ///< in the order of the leaves
};

/// Triangles without area are left out. Normals: corner_normals.h. Memory: mesh_limits.h.
/// Fails if there are more than MAX_TRIANGLES_SHOWN,
/// or a corner is further away than surfaces may be (surface_tree.h).
MeshTree mesh_tree(std::span<const MeshShape> meshes, const VolumeInfo& volume);

}  // namespace shvr
