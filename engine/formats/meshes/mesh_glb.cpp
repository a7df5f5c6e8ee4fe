#include <map>

#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/formats/meshes/glb_content.h"
#include "engine/formats/meshes/mesh_builder.h"
#include "engine/formats/meshes/mesh_forms.h"

namespace shvr {
namespace {

constexpr uint32_t VERSION = 2, JSON = 0x4E4F534A, BINARY = 0x004E4942;
constexpr uint64_t HEADER_BYTES = 12, CHUNK_HEADER_BYTES = 8;
constexpr uint64_t MAX_JSON_BYTES = uint64_t{16} << 20;
/// A byte of JSON becomes at most about this many bytes of values, as in {},{},{}.
constexpr uint64_t JSON_EXPANSION = 64;

struct GlbChunks {
    std::string json;
    GlbBinary binary;
};

GlbChunks read_chunks(MeshInput& input, MeshMemory& memory)
{
    if (input.size() < HEADER_BYTES + CHUNK_HEADER_BYTES)
        fail(input.name(), ": has ", input.size(), " bytes; expected at least ", HEADER_BYTES + CHUNK_HEADER_BYTES);
    input.skip(4);  // "glTF"
    if (const auto version = input.value<uint32_t>(); version != VERSION)
        fail(input.name(), ": is glTF of version ", version, "; expected 2: export it as glTF 2.0");
    const auto bytes = input.value<uint32_t>();
    if (bytes > input.size())
        fail(input.name(), ": states ", bytes, " bytes, but has ", input.size(),
             "; expected all of them: copy it again");
    GlbChunks chunks;
    while (input.position() + CHUNK_HEADER_BYTES <= bytes) {
        const auto length = input.value<uint32_t>();
        const auto kind = input.value<uint32_t>();
        if (length > bytes - input.position())
            fail(input.name(), ": states a chunk of ", length, " bytes; expected at most ", bytes - input.position(),
                 ", which are left");
        if (chunks.json.empty()) {
            if (kind != JSON) fail(input.name(), ": begins with a chunk that is not JSON; expected JSON");
            if (length > MAX_JSON_BYTES)
                fail(input.name(), ": has ", length, " bytes of JSON; expected at most ", MAX_JSON_BYTES);
            memory.take((1 + JSON_EXPANSION) * length);
            chunks.json.resize(length);
            input.read(chunks.json);
            // Some programs fill the chunk up with zeros instead of spaces.
            chunks.json.erase(chunks.json.find_last_not_of('\0') + 1);
            if (chunks.json.empty()) fail(input.name(), ": has an empty chunk of JSON; expected the scene");
        } else if (kind == BINARY && chunks.binary.offset == 0) {
            chunks.binary = {input.position(), length};
            input.skip(length);
        } else {
            input.skip(length);
        }
    }
    if (chunks.json.empty()) fail(input.name(), ": has no chunk of JSON; expected the scene");
    return chunks;
}

class GlbFile {
public:
    GlbFile(MeshInput& input, MeshMemory& memory, const std::vector<GlbPrimitive>& primitives)
        : input_(input), builder_(input.name(), memory), primitives_(primitives)
    {}

    TriangleMesh read()
    {
        uint64_t points = 0, triangles = 0;
        for (size_t i = 0; i < primitives_.size(); ++i) {
            if (!shares_points(i)) points += primitives_[i].positions.count;
            triangles += primitives_[i].triangles();
        }
        builder_.expect_triangles(triangles);
        builder_.expect_points(points);
        for (size_t i = 0; i < primitives_.size(); ++i) {
            if (i == 0 || primitives_[i].node != primitives_[i - 1].node) firsts_.clear();
            const GlbPrimitive& primitive = primitives_[i];
            const auto [first, is_new] = firsts_.try_emplace(primitive.positions.number, uint32_t(builder_.points()));
            if (is_new) read_points(primitive);
            builder_.begin_part(primitive.name, primitive.color, builder_.triangles());
            read_triangles(primitive, first->second);
        }
        return builder_.finish();
    }

private:
    /// Whether an earlier primitive of the node has the same points.
    bool shares_points(size_t i)
    {
        if (i == 0 || primitives_[i].node != primitives_[i - 1].node) firsts_.clear();
        return !firsts_.try_emplace(primitives_[i].positions.number, 0).second;
    }

    void read_points(const GlbPrimitive& primitive)
    {
        const GlbAccessor& positions = primitive.positions;
        uint64_t i = 0;
        const auto where = [&] { return sentence(input_.name(), ": point ", i, " of accessor ", positions.number); };
        for (; i < positions.count; ++i) {
            input_.seek(positions.offset + i * positions.stride);
            const glm::vec3 stored = MeshBuilder::single_of(input_.value<glm::vec3>(), where);
            builder_.add_point(glm::dvec3(primitive.placed * glm::dvec4(stored, 1.0)), where);
        }
    }

    uint32_t corner_at(const GlbPrimitive& primitive, uint64_t i)
    {
        if (!primitive.indices) return uint32_t(i);
        const GlbAccessor& indices = *primitive.indices;
        input_.seek(indices.offset + i * indices.stride);
        const uint32_t index = indices.bytes == 1   ? input_.value<uint8_t>()
                               : indices.bytes == 2 ? input_.value<uint16_t>()
                                                    : input_.value<uint32_t>();
        if (index >= primitive.positions.count)
            fail(input_.name(), ": accessor ", indices.number, " has the index ", index, "; expected one of the ",
                 primitive.positions.count, " points, counted from 0");
        return index;
    }

    void read_triangles(const GlbPrimitive& primitive, uint32_t first)
    {
        // A mirrored triangle must turn the other way to be counter-clockwise from outside.
        const bool is_mirrored = glm::determinant(glm::dmat3(primitive.placed)) < 0.0;
        glm::uvec3 corners{0};
        const uint64_t count = primitive.corners();
        for (uint64_t i = 0; i < count; ++i) {
            const uint32_t corner = first + corner_at(primitive, i);
            bool is_odd = false;  // every other triangle of a strip turns the other way
            if (primitive.mode == GlbMode::triangles) {
                corners[int(i % 3)] = corner;
                if (i % 3 != 2) continue;
            } else {
                if (i < 3) corners[int(i)] = corner;
                if (i > 2) corners = {primitive.mode == GlbMode::fan ? corners.x : corners.y, corners.z, corner};
                if (i < 2) continue;
                is_odd = primitive.mode == GlbMode::strip && i % 2 == 1;
            }
            const bool turns = is_odd != is_mirrored;
            builder_.add_triangle(turns ? glm::uvec3(corners.x, corners.z, corners.y) : corners);
        }
    }

    MeshInput& input_;
    MeshBuilder builder_;
    const std::vector<GlbPrimitive>& primitives_;
    std::map<size_t, uint32_t> firsts_{};  ///< accessor -> its first point, in the current node
};

}  // namespace

TriangleMesh read_glb(MeshInput& input, MeshMemory& memory)
{
    GlbChunks chunks = read_chunks(input, memory);
    const JsonDocument json(chunks.json, input.name(),
                            {.depth = 64, .expected = "the JSON of glTF 2.0", .may_repeat_keys = true});
    const std::vector<GlbPrimitive> primitives = primitives_of(json, chunks.binary, memory);
    TriangleMesh mesh = GlbFile(input, memory, primitives).read();
    // glTF is in metres; our writer leaves the numbers as they are where the unit is no length.
    const MeshStatements statements = statements_of(json);
    add_statements(mesh, statements);
    if (mesh.metres && mesh.origin) *mesh.origin *= *mesh.metres;
    mesh.metres = statements.states_unit() ? (statements.metres() ? std::optional(1.0) : std::nullopt) : 1.0;
    return mesh;
}

}  // namespace shvr
