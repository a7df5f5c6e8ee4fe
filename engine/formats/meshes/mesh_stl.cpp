#include <array>
#include <utility>

#include "engine/base/text.h"
#include "engine/formats/meshes/mesh_builder.h"
#include "engine/formats/meshes/mesh_forms.h"
#include "engine/formats/meshes/mesh_statements.h"
#include "engine/formats/meshes/point_merger.h"
#include "engine/formats/meshes/stl_layout.h"

namespace shvr {
namespace {

/// Checks the number of triangles against the file.
void check_count(const MeshInput& input, uint64_t count)
{
    const uint64_t room = input.rest() / STL_TRIANGLE_BYTES;
    if (count > room)
        fail(input.name(), ": states ", count, " triangles; expected at most ", room, ", which its ", input.size(),
             " bytes can hold: copy it again, or is it no STL file?");
    if (count > MAX_MESH_TRIANGLES) refuse_triangles(input.name(), count);
    if (count < room)
        fail(input.name(), ": states ", count, " triangles, but its ", input.size(), " bytes can hold ", room,
             "; expected equal numbers: write it again");
}

/// Reads the statements of text STL, word by word.
class StlText {
public:
    StlText(MeshInput& input, MeshMemory& memory)
        : input_(input), builder_(input.name(), memory), merger_(builder_, memory, 0)
    {}

    TriangleMesh read()
    {
        skip_byte_order_mark(input_);
        expect("solid");
        bool is_open = true;
        begin_part();
        for (std::string word = next(); !word.empty(); word = next()) {
            if (word == "facet" && is_open) {
                read_facet();
            } else if (word == "endsolid" && is_open) {
                input_.line();
                is_open = false;
            } else if (word == "solid" && !is_open) {
                begin_part();
                is_open = true;
            } else {
                refuse(word, is_open ? "facet or endsolid" : "solid, or the end of the file");
            }
        }
        if (is_open) refuse("", "facet or endsolid");
        TriangleMesh mesh = builder_.finish();
        mesh.frame = statements_.frame();
        return mesh;
    }

private:
    std::string next() { return lower_case(input_.word()); }
    [[noreturn]] void refuse(std::string_view found, const char* expected) const
    {
        fail(input_.place(), ": has ", found.empty() ? "the end of the file" : in_quotes(found), "; expected ",
             expected);
    }
    void expect(const char* word)
    {
        if (const std::string found = next(); found != word) refuse(found, word);
    }
    void begin_part()
    {
        const std::string_view name = input_.line().value_or("");
        statements_.take(name);
        builder_.begin_part(name);
    }
    void read_facet()
    {
        expect("normal");
        for (int axis = 0; axis < 3; ++axis) input_.word();
        expect("outer");
        expect("loop");
        MeshFan fan(builder_);
        std::string word = next();
        for (; word == "vertex"; word = next()) {
            glm::dvec3 at;
            for (int axis = 0; axis < 3; ++axis) at[axis] = number_in(input_, input_.word());
            fan.add(merger_.index_of(MeshBuilder::single_of(at, [&] { return input_.place(); })));
        }
        if (word != "endloop" || fan.corners() < 3) refuse(word, fan.corners() < 3 ? "vertex" : "vertex or endloop");
        expect("endfacet");
    }

    MeshInput& input_;
    MeshBuilder builder_;
    MeshStatements statements_{};
    PointMerger merger_;
};

}  // namespace

TriangleMesh read_stl_binary(MeshInput& input, MeshMemory& memory)
{
    if (input.size() < STL_FIRST_TRIANGLE)
        fail(input.name(), ": has ", input.size(), " bytes; expected at least ", STL_FIRST_TRIANGLE, " of an STL file");
    std::array<char, STL_HEADER_BYTES> header;
    input.read(header);
    const auto count = input.value<uint32_t>();
    check_count(input, count);
    MeshStatements statements;
    statements.take_stl_header({header.data(), header.size()});

    MeshBuilder builder(input.name(), memory);
    if (statements.stl_group()) builder.begin_part(statements.name_of_group(*statements.stl_group()));
    builder.expect_triangles(count);
    // A closed surface has half as many points as triangles.
    PointMerger merger(builder, memory, count / 2 + 2);
    builder.expect_points(std::min<uint64_t>(3 * uint64_t{count}, count / 2 + 64));
    for (uint32_t triangle = 0; triangle < count; ++triangle) {
        struct {
            glm::vec3 normal, corners[3];
        } stored;
        static_assert(sizeof stored == 48);
        stored = input.value<decltype(stored)>();
        static_cast<void>(input.value<uint16_t>());
        glm::uvec3 corners;
        for (int i = 0; i < 3; ++i)
            corners[i] = merger.index_of(MeshBuilder::single_of(
                stored.corners[i], [&] { return sentence(input.name(), ": triangle ", triangle + 1); }));
        builder.add_triangle(corners);
    }
    TriangleMesh mesh = builder.finish();
    add_statements(mesh, statements);
    return mesh;
}

TriangleMesh read_stl_text(MeshInput& input, MeshMemory& memory)
{
    return StlText(input, memory).read();
}

}  // namespace shvr
