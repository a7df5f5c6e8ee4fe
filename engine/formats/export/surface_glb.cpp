#include <limits>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/formats/export/surface_forms.h"

namespace shvr {

namespace {

using Json = nlohmann::json;

constexpr uint64_t BYTES_PER_VERTEX = 12, BYTES_PER_TRIANGLE = 12;
constexpr int FLOATS = 5126, UNSIGNED_INTS = 5125, VERTICES_OF = 34962, INDICES_OF = 34963;

struct Box {
    glm::vec3 lower{std::numeric_limits<float>::max()}, upper{std::numeric_limits<float>::lowest()};
};

Json numbers(const glm::vec3& value)
{
    return {value.x, value.y, value.z};
}

Json material_of(const SurfacePart& part)
{
    return {{"name", part.name},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {part.color.r, part.color.g, part.color.b, 1.0}},
              {"metallicFactor", 0.0},
              {"roughnessFactor", 0.7}}}};
}

/// Returns the JSON of the file, whose binary chunk holds vertices and triangles of each part in turn.
Json content_of(const SurfaceParts& surfaces, const std::vector<Box>& boxes, uint64_t bytes)
{
    Json content{{"asset", {{"version", "2.0"}, {"generator", "SHVR"}, {"extras", {{"comments", surfaces.comments}}}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"buffers", {{{"byteLength", bytes}}}}};
    const double scale = surfaces.metres.value_or(1.0);
    const glm::dvec3 origin = scale * surfaces.origin;
    Json root{{"name", "surfaces"}, {"translation", {origin.x, origin.y, origin.z}}, {"scale", {scale, scale, scale}}};
    uint64_t offset = 0;
    for (size_t i = 0; i < surfaces.parts.size(); ++i) {
        const SurfacePart& part = surfaces.parts[i];
        const uint64_t vertices = BYTES_PER_VERTEX * part.vertices, triangles = BYTES_PER_TRIANGLE * part.triangles;
        content["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", vertices}, {"target", VERTICES_OF}});
        content["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset + vertices}, {"byteLength", triangles}, {"target", INDICES_OF}});
        offset += vertices + triangles;
        content["accessors"].push_back({{"bufferView", 2 * i},
                                        {"componentType", FLOATS},
                                        {"count", part.vertices},
                                        {"type", "VEC3"},
                                        {"min", numbers(boxes[i].lower)},
                                        {"max", numbers(boxes[i].upper)}});
        content["accessors"].push_back({{"bufferView", 2 * i + 1},
                                        {"componentType", UNSIGNED_INTS},
                                        {"count", 3 * part.triangles},
                                        {"type", "SCALAR"}});
        content["materials"].push_back(material_of(part));
        const Json primitive{{"attributes", {{"POSITION", 2 * i}}}, {"indices", 2 * i + 1}, {"material", i}};
        content["meshes"].push_back({{"name", part.name}, {"primitives", Json::array({primitive})}});
        content["nodes"].push_back({{"name", part.name}, {"mesh", i}, {"extras", {{"group", part.group}}}});
        root["children"].push_back(i + 1);
    }
    content["nodes"].insert(content["nodes"].begin(), root);
    return content;
}

}  // namespace

void export_glb(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress)
{
    constexpr uint32_t MAGIC = 0x46546C67, VERSION = 2, JSON = 0x4E4F534A, BINARY = 0x004E4942;
    PartProgress steps(progress, 3 * surfaces.parts.size());
    const auto written = [&](const glm::dvec3& position) { return glm::vec3(position - surfaces.origin); };
    std::vector<Box> boxes;
    uint64_t bytes = 0;
    for (const SurfacePart& part : surfaces.parts) {
        Box box;
        const auto take = [&](const glm::dvec3& position) {
            box.lower = glm::min(box.lower, written(position));
            box.upper = glm::max(box.upper, written(position));
        };
        surfaces.for_each_vertex(part, take, steps.next());
        boxes.push_back(box);
        bytes += BYTES_PER_VERTEX * part.vertices + BYTES_PER_TRIANGLE * part.triangles;
    }
    std::string json = content_of(surfaces, boxes, bytes).dump(-1, ' ', false, Json::error_handler_t::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const uint64_t size = 12 + 8 + json.size() + 8 + bytes;
    if (size > UINT32_MAX)
        fail(path.string(), ": would have ", size, " bytes; expected at most 4294967295, which .glb allows: write ",
             "fewer groups, or .ply");
    SurfaceWriter writer(path, size);
    writer.values(MAGIC, VERSION, uint32_t(size), uint32_t(json.size()), JSON);
    writer.text(json);
    writer.values(uint32_t(bytes), BINARY);
    for (const SurfacePart& part : surfaces.parts) {
        surfaces.for_each_vertex(
            part, [&](const glm::dvec3& position) { writer.values(written(position)); }, steps.next());
        surfaces.for_each_triangle(
            part, [&](const glm::uvec3& indices, const auto&) { writer.values(indices); }, steps.next());
    }
    writer.commit();
}

}  // namespace shvr
