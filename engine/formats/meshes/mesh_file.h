#pragma once
// Triangle meshes in files of other programs, for display: STL (binary and text), PLY (text and binary), OBJ and binary
// glTF 2.0 (.glb). The format is found by content; OBJ, which has no signature, also by its extension. Any thread.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/progress.h"

namespace shvr {

/// Limit of the triangles of a file.
inline constexpr uint64_t MAX_MESH_TRIANGLES = uint64_t{1} << 23;

struct MeshPart {
    std::string name;                ///< without control characters; empty if the file states none
    std::optional<glm::vec3> color;  ///< sRGB 0..1; null if the file states none or several
    uint32_t begin = 0, end = 0;     ///< triangles
};

struct TriangleMesh {
    std::vector<glm::vec3> points;      ///< in the file's unit, finite; some may belong to no triangle
    std::vector<glm::uvec3> triangles;  ///< counter-clockwise from outside, as in the file; some may have no area
    std::vector<MeshPart> parts;        ///< cover all triangles in order; at least one
    std::optional<double> metres;       ///< length of the unit; null if the file does not state it
    std::string positions;              ///< "physical" or "volume" if the file states it as ours do, else empty
    std::string frame;                  ///< "LPS" or "RAS", along whose axes physical positions run; else empty
    /// Where the volume lies of which a file of ours was made, in the unit of the points; null if it states none.
    std::optional<glm::dvec3> origin;
    std::optional<glm::dmat3> directions;
};

/// Whether the file begins like a mesh of one of the formats. False for a file that cannot be read.
bool is_mesh_file(const std::filesystem::path& path);

/// Reads a mesh of at least one triangle. `memory`: bytes that it may take while it reads. Fails, before it takes that
/// memory, if counts exceed the file, `memory` or MAX_MESH_TRIANGLES, and if the file is truncated or damaged.
TriangleMesh read_mesh(const std::filesystem::path& path, uint64_t memory, const Progress& progress);

}  // namespace shvr
