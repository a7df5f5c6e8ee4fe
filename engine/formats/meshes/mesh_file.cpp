#include "engine/formats/meshes/mesh_file.h"

#include <algorithm>
#include <array>

#include "engine/base/text.h"
#include "engine/formats/meshes/mesh_forms.h"
#include "engine/formats/meshes/stl_layout.h"

namespace shvr {
namespace {

constexpr size_t HEAD_BYTES = size_t{1} << 16;
constexpr std::string_view BYTE_ORDER_MARK = "\xef\xbb\xbf";

using ReadMesh = TriangleMesh (*)(MeshInput&, MeshMemory&);

std::string_view without_mark(std::string_view head)
{
    return head.starts_with(BYTE_ORDER_MARK) ? head.substr(BYTE_ORDER_MARK.size()) : head;
}

/// Whether a line begins with a statement of OBJ.
bool is_obj(std::string_view head)
{
    constexpr std::string_view STATEMENTS[] = {"v", "vn", "vt", "f", "l", "p", "o", "g", "s", "usemtl", "mtllib"};
    if (head.find('\0') != std::string_view::npos) return false;
    std::string_view rest = without_mark(head);
    while (!rest.empty()) {
        const std::string_view line = trimmed(take_line(rest));
        const std::string_view word = line.substr(0, line.find_first_of(" \t"));
        if (std::ranges::find(STATEMENTS, word) != std::end(STATEMENTS) && word.size() < line.size()) return true;
    }
    return false;
}

bool is_stl_text(std::string_view head, bool is_named_so)
{
    if (head.find('\0') != std::string_view::npos) return false;
    const std::string text = lower_case(trimmed(without_mark(head)));
    if (!text.starts_with("solid") || text.find_first_of(" \t\r\n") != 5) return false;
    return is_named_so || text.find("facet") != std::string::npos || text.find("endsolid") != std::string::npos;
}

/// Null if the file is none of the formats.
ReadMesh reader_of(MeshInput& input, const std::string& extension)
{
    const std::string_view head = input.peek(HEAD_BYTES);
    if (head.starts_with("ply\n") || head.starts_with("ply\r\n")) return read_ply;
    if (head.starts_with("glTF")) return read_glb;
    // Some programs begin binary files with "solid", too.
    if (is_stl_of_its_size(head, input.size())) return read_stl_binary;
    if (is_stl_text(head, extension == ".stl")) return read_stl_text;
    if (extension == ".stl") return read_stl_binary;  // which says what is wrong
    if (extension == ".obj" && is_obj(head)) return read_obj;
    return nullptr;
}

std::string extension_of(const std::filesystem::path& path)
{
    return lower_case(path.extension().string());
}

}  // namespace

void add_statements(TriangleMesh& mesh, const MeshStatements& statements)
{
    mesh.metres = statements.metres();
    mesh.positions = statements.positions();
    mesh.frame = statements.frame();
    mesh.origin = statements.origin();
    mesh.directions = statements.directions();
}

void skip_byte_order_mark(MeshInput& input)
{
    if (input.peek(BYTE_ORDER_MARK.size()) == BYTE_ORDER_MARK) input.skip(BYTE_ORDER_MARK.size());
}

double number_in(const MeshInput& input, std::string_view word)
{
    const std::optional<double> number = number_of(word);
    if (!number)
        fail(input.place(), word.empty() ? ": ends too early" : ": has " + in_quotes(word), "; expected a number");
    return *number;
}

bool is_mesh_file(const std::filesystem::path& path)
{
    try {
        MeshMemory memory(path.string(), MeshInput::MAX_BUFFER_BYTES);
        MeshInput input(path, memory, {});
        return reader_of(input, extension_of(path)) != nullptr;
    } catch (const Error&) {
        return false;
    }
}

TriangleMesh read_mesh(const std::filesystem::path& path, uint64_t memory, const Progress& progress)
{
    MeshMemory budget(path.string(), memory);
    MeshInput input(path, budget, progress);
    const ReadMesh read = reader_of(input, extension_of(path));
    if (read == nullptr)
        fail(path.string(), ": begins like no mesh that can be read; expected STL, PLY, binary glTF (.glb), or OBJ in ",
             "a file that is named .obj");
    return read(input, budget);
}

}  // namespace shvr
