#pragma once
// Normals at the corners of a mesh's triangles. Plain data; any thread.

#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

#include "engine/look/surfaces/mesh_tree.h"

namespace shvr {

/// A corner's normal is the mean of those of the triangles around its point that are turned from its own by at most 30
/// degrees, weighted by the angles there (Thuermer and Wuethrich 1998). Around a point of more than 64 triangles, all
/// count, so that the work stays linear.
class CornerNormals {
public:
    /// Keeps a reference to the mesh.
    explicit CornerNormals(const MeshShape& mesh);
    bool has_area(size_t triangle) const { return normals_[triangle] != glm::dvec3(0.0); }
    /// Of unit length. `corner`: 0 to 2, of a triangle with an area.
    glm::dvec3 at(size_t triangle, int corner) const;

private:
    struct Entry {
        uint32_t triangle;
        float angle;  ///< at the point
    };
    const MeshShape& mesh_;
    std::vector<glm::dvec3> normals_{};  ///< of unit length; 0 for a triangle without area
    std::vector<size_t> begins_{};       ///< for each point, its first in `entries_`; and the end
    std::vector<Entry> entries_{};
    std::unordered_map<uint32_t, glm::dvec3> joint_{};  ///< by point, of more than 64 triangles: the sum of all
};

}  // namespace shvr
