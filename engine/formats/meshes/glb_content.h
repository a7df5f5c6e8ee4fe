#pragma once
// What a binary glTF file shows: its scene as a flat list of primitives of triangles. One thread.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/json.h"
#include "engine/formats/meshes/mesh_memory.h"
#include "engine/formats/meshes/mesh_statements.h"

namespace shvr {

/// Numbers in the file; checked to lie within its binary chunk.
struct GlbAccessor {
    size_t number = 0;    ///< among the accessors of the file
    uint64_t offset = 0;  ///< where the first element is in the file
    uint64_t stride = 0, count = 0;
    uint64_t bytes = 0;  ///< size of a whole number: 1, 2 or 4
};

enum class GlbMode { triangles = 4, strip = 5, fan = 6 };

struct GlbPrimitive {
    size_t node = 0;
    glm::dmat4 placed{1.0};  ///< to the scene, in metres
    GlbAccessor positions{};
    std::optional<GlbAccessor> indices{};
    GlbMode mode = GlbMode::triangles;
    std::string name{};
    std::optional<glm::vec3> color{};

    uint64_t corners() const { return indices ? indices->count : positions.count; }
    uint64_t triangles() const { return mode == GlbMode::triangles ? corners() / 3 : corners() - 2; }
};

/// Where the binary chunk lies in the file.
struct GlbBinary {
    uint64_t offset = 0, bytes = 0;
};

/// The primitives of the scene, in the order of its nodes. Fails if it needs what is not supported.
std::vector<GlbPrimitive> primitives_of(const JsonDocument& json, const GlbBinary& binary, MeshMemory& memory);
/// Comments of SHVR's writer.
MeshStatements statements_of(const JsonDocument& json);

}  // namespace shvr
