#pragma once
// A trace as tubes of triangles: a ball for each node and a truncated cone for each internode. Each is closed, and its
// triangles are counter-clockwise seen from outside. Vertices lie on the true surface, so the meshes are slightly too
// small (a cone's cross-section by 2.6 %, a ball's volume by 12 %). Parts overlap where they meet.
//
//   .obj   a group "group_N" for each colour group; text
//   .ply   binary; coordinates of 64 bits, since volumes may lie far from 0; each face has the property `group`
//
// Positions are in physical space unless volume space is requested (trace_space.h). Comments in the file state the
// space, place and unit; "SPACE=LPS" is 3D Slicer's notation for a mesh's axes. Any thread may call these.

#include <filesystem>
#include <vector>

#include "engine/annotation/trace/trace_file.h"

namespace shvr {

struct TracePart {
    uint8_t group = 0;
    std::vector<glm::dvec3> vertices;
    std::vector<glm::uvec3> triangles;
};
/// Empty if the radius is 0.
TracePart mesh_of(const TraceNode& node);
/// Empty if the internode has no length or no radius.
TracePart mesh_of(const TraceGraph& trace, const TraceInternode& internode);

/// Writes as AtomicWriter does, group by group.
void save_trace_mesh(const std::filesystem::path& path, const TraceGraph& trace, const TraceSpace& space,
                     Positions positions = Positions::physical);

}  // namespace shvr
