#pragma once
// Joins corners of triangles at equal positions to one point. One thread.

#include <cstdint>
#include <vector>

#include "engine/formats/meshes/mesh_builder.h"

namespace shvr {

class PointMerger {
public:
    /// `points`: the number that may be expected; more are accepted.
    PointMerger(MeshBuilder& builder, MeshMemory& memory, uint64_t points);
    /// The point at a finite position, added to the builder if it is the first there.
    uint32_t index_of(glm::vec3 at);

private:
    void resize(uint64_t slots);
    size_t slot_of(const glm::vec3& at) const;

    MeshBuilder& builder_;
    MeshMemory& memory_;
    std::vector<uint32_t> slots_;  ///< open addressing: indices of points, or EMPTY; a power of two of them
};

}  // namespace shvr
