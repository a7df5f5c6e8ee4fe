#include <utility>

#include "engine/base/text.h"
#include "engine/formats/meshes/mesh_builder.h"
#include "engine/formats/meshes/mesh_forms.h"
#include "engine/formats/meshes/mesh_statements.h"

namespace shvr {
namespace {

constexpr std::string_view BLANKS = " \t\r\v\f";

/// Removes the first word from `rest`; empty if there is none.
std::string_view take_word(std::string_view& rest)
{
    rest.remove_prefix(std::min(rest.find_first_not_of(BLANKS), rest.size()));
    const std::string_view word = rest.substr(0, rest.find_first_of(BLANKS));
    rest.remove_prefix(word.size());
    return word;
}

class ObjFile {
public:
    ObjFile(MeshInput& input, MeshMemory& memory) : input_(input), builder_(input.name(), memory) {}

    TriangleMesh read()
    {
        skip_byte_order_mark(input_);
        while (const std::optional<std::string_view> line = input_.line()) {
            std::string_view rest = *line;
            const std::string_view word = take_word(rest);
            if (word.starts_with('#')) {
                statements_.take(trimmed(*line).substr(1));
            } else if (word == "v") {
                read_point(rest);
            } else if (word == "f") {
                read_face(rest);
            } else if (word == "g" || word == "o") {
                builder_.begin_part(statements_.name_of_obj_group(trimmed(rest)));
            }  // Other statements say nothing about the shape of triangles.
        }
        if (farthest_ > builder_.points()) refuse_index(farthest_place_, std::to_string(farthest_));
        TriangleMesh mesh = builder_.finish();
        add_statements(mesh, statements_);
        return mesh;
    }

private:
    [[noreturn]] void refuse_index(const std::string& place, std::string_view found) const
    {
        fail(place, ": has the corner ", in_quotes(found), "; expected the number of a vertex, of which the file has ",
             builder_.points());
    }

    void read_point(std::string_view rest)
    {
        glm::dvec3 at;
        for (int axis = 0; axis < 3; ++axis) at[axis] = number_in(input_, take_word(rest));
        builder_.add_point(at, [&] { return input_.place(); });
    }

    /// The index of a corner such as 7, 7/1, 7/1/3, 7//3 or -1, from 0.
    uint32_t corner_of(std::string_view word)
    {
        const std::optional<int64_t> index = whole_of(word.substr(0, word.find('/')));
        const auto points = int64_t(builder_.points());
        if (!index || *index == 0 || *index < -points || *index > int64_t{UINT32_MAX})
            refuse_index(input_.place(), word);
        // Vertices may follow the faces that use them.
        if (*index > points && uint64_t(*index) > farthest_) {
            farthest_ = uint64_t(*index);
            farthest_place_ = input_.place();
        }
        return uint32_t(*index < 0 ? points + *index : *index - 1);
    }

    void read_face(std::string_view rest)
    {
        MeshFan fan(builder_);
        for (;;) {
            std::string_view word = take_word(rest);
            // A backslash at the end continues the line.
            const bool continues = word.ends_with('\\') && trimmed(rest).empty();
            if (continues) word.remove_suffix(1);
            if (word.starts_with('#')) break;
            if (!word.empty()) fan.add(corner_of(word));
            if (word.empty() && !continues) break;
            if (continues) rest = input_.line().value_or("");
        }
        if (fan.corners() < 3)
            fail(input_.place(), ": has a face of ", counted(int64_t(fan.corners()), "corner"),
                 "; expected 3 or more corners");
    }

    MeshInput& input_;
    MeshBuilder builder_;
    MeshStatements statements_{};
    uint64_t farthest_ = 0;  ///< the greatest index that was ahead of the vertices read so far, from 1
    std::string farthest_place_{};
};

}  // namespace

TriangleMesh read_obj(MeshInput& input, MeshMemory& memory)
{
    return ObjFile(input, memory).read();
}

}  // namespace shvr
