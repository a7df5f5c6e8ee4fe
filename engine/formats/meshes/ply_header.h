#pragma once
// The header of a PLY file: how its values are coded, and its elements with their properties. One thread.

#include <bit>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/formats/meshes/mesh_input.h"
#include "engine/formats/meshes/mesh_statements.h"

namespace shvr {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
uint64_t bytes_of(PlyType type);
bool is_float(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;      ///< in a list, type of its values
    std::optional<PlyType> count_type{};  ///< type of a list's length; null: one value
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties{};

    /// Null if there is none.
    const PlyProperty* find(std::string_view property) const;
};

struct PlyHeader {
    std::optional<std::endian> order{};  ///< of binary values; null: text
    std::vector<PlyElement> elements{};
    MeshStatements statements{};

    const PlyElement* find(std::string_view element) const;
};

/// The list of corners of a face; null if there is none.
const PlyProperty* corners_of(const PlyElement& face);

/// Reads the header from the beginning of the file, and checks it: that it has vertices with x, y and z and faces with
/// lists of them, and that the rest of the file can hold as many of all elements.
PlyHeader read_ply_header(MeshInput& input);

}  // namespace shvr
