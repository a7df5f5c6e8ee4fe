#include <cmath>
#include <limits>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/base/image.h"
#include "tests/unit/formats/meshes/mesh_files.h"

using namespace shvr;
using namespace shvr::test;
using Json = nlohmann::json;

namespace {

/// Two triangles of a square with indices of 16 bits, and the same positions with 4 spare bytes each: 48, 12, 64 bytes.
std::string square_binary()
{
    const glm::vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    std::string bytes;
    for (const glm::vec3& at : corners) bytes += raw(at);
    for (const int index : {0, 1, 2, 0, 2, 3}) bytes += raw(uint16_t(index));
    for (const glm::vec3& at : corners) bytes += raw(at, uint32_t{0x7fc00000});
    return bytes;
}

Json square()
{
    return Json::parse(R"({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "node"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": 124}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
                        {"buffer": 0, "byteOffset": 60, "byteLength": 64, "byteStride": 16}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}]})");
}

/// The square with changes: JSON pointers and values.
Json changed(const std::vector<std::pair<const char*, Json>>& changes)
{
    Json json = square();
    for (const auto& [pointer, value] : changes) json[Json::json_pointer(pointer)] = value;
    return json;
}

const std::vector<glm::vec3> CORNERS{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<glm::uvec3> TRIANGLES{{0, 1, 2}, {0, 2, 3}};

struct Glb {
    TemporaryFolder folder{};
    TriangleMesh read(const Json& json, const std::string& binary = square_binary()) const
    {
        return mesh_of(folder, "a.data", glb_of(json.dump(), binary));
    }
    std::string refusal(const std::vector<std::pair<const char*, Json>>& changes) const
    {
        return refusal_of(folder, "a.glb", glb_of(changed(changes).dump(), square_binary()));
    }
};

}  // namespace

TEST_CASE_FIXTURE(Glb, "a square of binary glTF is read, in metres, also from spaced positions")
{
    for (const int positions : {0, 2}) {
        const TriangleMesh mesh = read(changed({{"/meshes/0/primitives/0/attributes/POSITION", positions}}));
        CHECK(mesh.points == CORNERS);
        CHECK(mesh.triangles == TRIANGLES);
        REQUIRE(mesh.parts.size() == 1);
        CHECK(mesh.parts[0].name == "node");
        CHECK(!mesh.parts[0].color);
        CHECK(mesh.metres == 1.0);
        CHECK(mesh.positions.empty());
    }
    // Without a scene, all nodes are shown; further chunks and bytes after the end do not matter.
    Json json = square();
    json.erase("scene");
    json.erase("scenes");
    CHECK(read(json).triangles == TRIANGLES);
    CHECK(mesh_of(folder, "a.glb", glb_of(json.dump(), square_binary()) + "more").triangles == TRIANGLES);
}

TEST_CASE_FIXTURE(Glb, "indices of 8, 16 and 32 bits and none give triangles, strips and fans")
{
    const std::string points = square_binary().substr(0, 48);
    const auto read_as = [&](int mode, int type, const std::string& indices, int count) {
        Json json = changed({{"/meshes/0/primitives/0/mode", mode},
                             {"/accessors/1/componentType", type},
                             {"/accessors/1/count", count},
                             {"/bufferViews/1/byteLength", indices.size()}});
        if (indices.empty()) json["meshes"][0]["primitives"][0].erase("indices");
        return read(json, points + indices + "....").triangles;
    };
    const std::string bytes("\0\1\2\0\2\3", 6);
    std::string words;
    for (const uint32_t index : {0u, 1u, 2u, 0u, 2u, 3u}) words += raw(index);
    CHECK(read_as(4, 5121, bytes, 6) == TRIANGLES);
    CHECK(read_as(4, 5125, words, 6) == TRIANGLES);
    CHECK(read_as(5, 5121, bytes, 5) == std::vector<glm::uvec3>{{0, 1, 2}, {1, 0, 2}, {2, 0, 2}});
    CHECK(read_as(5, 5121, "", 0) == std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}});
    CHECK(read_as(6, 5121, "", 0) == TRIANGLES);
    CHECK(read_as(6, 5121, bytes.substr(3), 3) == std::vector<glm::uvec3>{{0, 2, 3}});
}

// Kind (Meshes): nodes of glTF with matrices, rotations and mirrors
TEST_CASE_FIXTURE(Glb, "points are placed by the transforms of all nodes above them")
{
    const double half = std::sqrt(0.5);  // of a rotation by 90 degrees about z
    const auto child = [](const Json& transform) {
        Json node = {{"mesh", 0}};
        node.update(transform);
        return Json{{{"children", {1}}, {"translation", {10, 20, 30}}, {"scale", {2, 2, 2}}}, node};
    };
    const auto placed = [&](const Json& transform) { return read(changed({{"/nodes", child(transform)}})); };
    const std::vector<glm::vec3> expected{{10, 20, 34}, {10, 26, 34}, {8, 26, 34}, {8, 20, 34}};
    const TriangleMesh turned =
        placed({{"rotation", {0, 0, half, half}}, {"scale", {3, 1, 1}}, {"translation", {0, 0, 2}}});
    for (int i = 0; i < 4; ++i) CHECK(glm::distance(turned.points[size_t(i)], expected[size_t(i)]) < 1e-5f);
    CHECK(turned.triangles == TRIANGLES);
    CHECK(placed({{"matrix", {0, 3, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1}}}).points == expected);
    // A mirror turns triangles inside out, unless their corners are exchanged.
    const TriangleMesh mirrored = placed({{"scale", {-1, 1, 1}}});
    CHECK(mirrored.points[1] == glm::vec3(8, 20, 30));
    CHECK(mirrored.triangles == std::vector<glm::uvec3>{{0, 2, 1}, {0, 3, 2}});
}

TEST_CASE_FIXTURE(Glb, "each primitive of each node is a part, with the base colour of its material")
{
    const Json primitive = square()["meshes"][0]["primitives"][0];
    Json red = primitive, lines = primitive, plain = primitive;
    red["material"] = 0;
    plain["material"] = 1;
    lines["mode"] = 1;
    const Json material = {{"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.25, 0.0, 0.5}}}}};
    const TriangleMesh mesh = read(changed({
        {"/meshes", {{{"name", "me\nsh"}, {"primitives", {red, lines, plain}}}}},
        {"/materials", {material, {{"name", "without a colour"}}}},
        {"/nodes", {{{"children", {2, 1}}}, {{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}, {{"mesh", 0}}}},
    }));
    REQUIRE(mesh.parts.size() == 4);
    CHECK(mesh.points.size() == 8);  // once in each node
    CHECK(mesh.points[1] == glm::vec3(6, 0, 0));
    CHECK(mesh.points[5] == glm::vec3(1, 0, 0));
    CHECK(mesh.triangles.size() == 8);
    CHECK(mesh.triangles[3] == glm::uvec3(0, 2, 3));
    CHECK(mesh.triangles[7] == glm::uvec3(4, 6, 7));
    CHECK(mesh.parts[2].name == "me?sh");
    CHECK(mesh.parts[2].color == glm::vec3(1.0f, float(srgb_encode(0.25)), 0.0f));
    CHECK(!mesh.parts[3].color);
    CHECK(mesh.parts[3].begin == 6);
    CHECK(mesh.parts[3].end == 8);
}

TEST_CASE_FIXTURE(Glb, "glTF that needs what is not supported is refused with its key")
{
    CHECK(contains(refusal({{"/asset/version", "1.0"}}), "key asset.version is \"1.0\"; expected \"2.0\""));
    CHECK(contains(refusal({{"/extensionsRequired", {"KHR_draco_mesh_compression"}}}),
                   "key extensionsRequired.0 is \"KHR_draco_mesh_compression\"; expected none: export it without"));
    CHECK(contains(refusal({{"/nodes/0/extensions/EXT_mesh_gpu_instancing", Json::object()}}),
                   "key nodes.0.extensions.EXT_mesh_gpu_instancing: states copies of a mesh; expected none"));
    const Json unlit = changed({{"/extensionsRequired", {"KHR_materials_unlit"}}});
    CHECK(mesh_of(folder, "a.glb", glb_of(unlit.dump(), square_binary())).triangles == TRIANGLES);
    CHECK(contains(refusal({{"/nodes/0/skin", 0}}), "key nodes.0.skin is 0; expected a mesh without a skeleton"));
    CHECK(contains(refusal({{"/accessors/0/sparse", Json::object()}}), "key accessors.0.sparse is {}; expected"));
    CHECK(contains(refusal({{"/accessors/0/type", "VEC2"}}), "key accessors.0.type is \"VEC2\"; expected VEC3"));
    CHECK(contains(refusal({{"/accessors/0/componentType", 5122}}), "key accessors.0.componentType is 5122"));
    CHECK(contains(refusal({{"/accessors/1/type", "VEC3"}}), "key accessors.1.type is \"VEC3\"; expected SCALAR"));
    CHECK(contains(refusal({{"/accessors/1/componentType", 5124}}), "expected 5121, 5123 or 5125, for indices"));
    CHECK(contains(refusal({{"/buffers/0/uri", "a.bin"}}),
                   "key buffers.0.uri is \"a.bin\"; expected none: export it as one .glb file"));
    CHECK(
        contains(refusal({{"/bufferViews/0/byteStride", 8}}), "key bufferViews.0.byteStride is 8; expected at least"));
    CHECK(contains(refusal({{"/nodes/0/rotation", {0, 0, 0, 0}}}), "expected a quaternion of length 1"));
    CHECK(contains(refusal({{"/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}),
                   "expected a matrix whose last row is 0 0 0 1"));
    const std::string old = "glTF" + raw(uint32_t{1}, uint32_t{20}, uint32_t{0}, uint32_t{0});
    CHECK(contains(refusal_of(folder, "a.glb", old), "is glTF of version 1; expected 2"));
}

TEST_CASE_FIXTURE(Glb, "damaged glTF is refused")
{
    const std::string file = glb_of(square().dump(), square_binary());
    check_cuts(folder, "a.glb", file, file.size());
    CHECK(contains(refusal({{"/accessors/0/count", 5}}),
                   "key accessors.0.count: is 5, for which its buffer view needs 60 bytes; expected at most 48"));
    CHECK(contains(refusal({{"/accessors/0/count", 4000000000}}), "for which its buffer view needs 48000000000 bytes"));
    CHECK(contains(refusal({{"/bufferViews/0/byteLength", 125}}),
                   "key bufferViews.0.byteLength: ends at byte 125 of the binary chunk; expected at most 124"));
    CHECK(contains(refusal({{"/accessors/1/byteOffset", 1}}), "needs 13 bytes; expected at most 12"));
    CHECK(contains(refusal({{"/accessors/1/count", 5}}), "has 5 corners; expected three for each triangle"));
    CHECK(contains(refusal({{"/meshes/0/primitives/0/mode", 5}, {"/accessors/1/count", 2}}), "has 2 corners"));
    CHECK(contains(refusal({{"/accessors/0/count", 3}}), ": accessor 1 has the index 3; expected one of the 3 points"));
    CHECK(contains(refusal({{"/nodes/0/mesh", 1}}), "key nodes.0.mesh is 1; expected 0"));
    CHECK(contains(refusal({{"/nodes/0/children", {0}}}), "key nodes.0: is reached twice; expected nodes that form"));
    CHECK(contains(refusal({{"/meshes", Json::array()}}), "key nodes.0.mesh: refers to meshes, which the file lacks"));
    CHECK(contains(refusal({{"/scenes/0/nodes", Json::array()}}), "holds no triangles; expected at least one"));
    CHECK(contains(refusal({{"/nodes/0/scale", {1e300, 1, 1}}}),
                   ": point 1 of accessor 0: has a corner with x = 1e+300"));
    CHECK(contains(refusal_of(folder, "a.glb", glb_of("[", "")), "is not JSON"));
    std::string large = file;
    large.replace(12, 4, raw(uint32_t{0xffffff00}));
    CHECK(contains(refusal_of(folder, "a.glb", large), "states a chunk of 4294967040 bytes; expected at most"));
    std::string nan = square_binary();
    nan.replace(4, 4, raw(std::numeric_limits<float>::quiet_NaN()));
    CHECK(contains(refusal_of(folder, "a.glb", glb_of(square().dump(), nan)), "has a corner with y = nan"));
}

TEST_CASE_FIXTURE(Glb, "triangles of many nodes that share a mesh are counted before memory is taken")
{
    Json nodes = Json::array(), roots = Json::array();
    for (int i = 0; i < 300; ++i) {
        nodes.push_back({{"mesh", 0}});
        roots.push_back(i);
    }
    Json json = changed({{"/nodes", nodes}, {"/scenes/0/nodes", roots}});
    CHECK(read(json).triangles.size() == 600);
    const std::string indices(size_t{3} << 15, '\0');
    json["bufferViews"][1]["byteLength"] = indices.size();
    json["accessors"][1].update({{"count", indices.size()}, {"componentType", 5121}});
    const Effort effort;
    CHECK(contains(refusal_of(folder, "a.glb", glb_of(json.dump(), square_binary().substr(0, 48) + indices)),
                   "holds 9830400 triangles; expected at most 8388608: decimate it"));
    CHECK(effort.is_below(AT_ONCE_BYTES));
}
