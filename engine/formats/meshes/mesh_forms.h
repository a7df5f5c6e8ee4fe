#pragma once
// The formats of mesh_file.h, a reader for each. The input is at the beginning of the file. One thread.

#include "engine/formats/meshes/mesh_file.h"
#include "engine/formats/meshes/mesh_input.h"
#include "engine/formats/meshes/mesh_statements.h"

namespace shvr {

TriangleMesh read_stl_binary(MeshInput& input, MeshMemory& memory);
TriangleMesh read_stl_text(MeshInput& input, MeshMemory& memory);
TriangleMesh read_ply(MeshInput& input, MeshMemory& memory);
TriangleMesh read_obj(MeshInput& input, MeshMemory& memory);
TriangleMesh read_glb(MeshInput& input, MeshMemory& memory);

/// Sets what the comments state: unit, space, frame and place.
void add_statements(TriangleMesh& mesh, const MeshStatements& statements);
/// Moves past the mark that some programs put before UTF-8.
void skip_byte_order_mark(MeshInput& input);
/// Parses a number of a text; fails, naming the line.
double number_in(const MeshInput& input, std::string_view word);

}  // namespace shvr
