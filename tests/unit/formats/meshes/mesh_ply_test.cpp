#include <doctest/doctest.h>

#include "tests/unit/formats/meshes/mesh_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const std::string QUADS =
    "ply\nformat ascii 1.0\ncomment made by a modeller\nobj_info num_cols 2\nelement vertex 6\nproperty float x\n"
    "property float y\nproperty float z\nproperty float nx\nproperty list uchar float weights\n"
    "element material 1\nproperty int shine\n"
    "element face 2\nproperty uchar flags\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\n"
    "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    "0 0 0 1 0\n1 0 0 1 2 0.5 0.5\n2 0 0 1 0\n0 1.5e0 0 1 0\n1 +1.5 -0 1 0\n2 1.5 0 1 0\n"
    "9\n"
    "7 4 0 1 4 3 8 0 0 1 0 1 1 0 1\n7 3 1 2 5 0\n"
    "0 1\n";

/// A binary file of one triangle and one quad in either byte order, with more properties than are used.
std::string binary(bool is_big)
{
    const auto stored = [&](auto value) { return is_big ? swapped(value) : raw(value); };
    std::string bytes = "ply\r\nformat binary_" + std::string(is_big ? "big" : "little") +
                        "_endian 1.0\r\nelement vertex 5\r\nproperty short quality\r\nproperty double z\r\n"
                        "property float32 x\r\nproperty float y\r\nelement face 2\r\nproperty list ushort uint16 "
                        "vertex_indices\r\nproperty list uint8 float64 texcoord\r\nend_header\r\n";
    for (int i = 0; i < 5; ++i)
        bytes += stored(int16_t(-i)) + stored(double(i) / 3) + stored(float(i)) + stored(float(100 * i));
    bytes += stored(uint16_t{3});
    for (const int corner : {2, 3, 4}) bytes += stored(uint16_t(corner));
    bytes += std::string(1, '\1') + stored(0.25);
    bytes += stored(uint16_t{4});
    for (const int corner : {0, 1, 2, 3}) bytes += stored(uint16_t(corner));
    return bytes + std::string(1, '\0');
}

std::string changed(std::string text, const std::string& found, const std::string& other)
{
    REQUIRE(text.find(found) != std::string::npos);
    return text.replace(text.find(found), found.size(), other);
}

}  // namespace

// Kind (Meshes): PLY with polygons, and with elements and properties that do not matter
TEST_CASE("polygons of text PLY become fans of triangles")
{
    const TemporaryFolder folder;
    const TriangleMesh mesh = mesh_of(folder, "a.data", QUADS);
    CHECK(mesh.triangles == std::vector<glm::uvec3>{{0, 1, 4}, {0, 4, 3}, {1, 2, 5}});
    CHECK(mesh.points ==
          std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1.5, 0}, {1, 1.5, 0}, {2, 1.5, 0}});
    REQUIRE(mesh.parts.size() == 1);
    CHECK(mesh.parts[0].end == 3);
    CHECK(!mesh.parts[0].color);
    CHECK(!mesh.metres);
}

TEST_CASE("binary PLY of both byte orders is read, with line ends of Windows in its header")
{
    const TemporaryFolder folder;
    for (const bool is_big : {false, true}) {
        const TriangleMesh mesh = mesh_of(folder, "a.ply", binary(is_big));
        CHECK(mesh.triangles == std::vector<glm::uvec3>{{2, 3, 4}, {0, 1, 2}, {0, 2, 3}});
        REQUIRE(mesh.points.size() == 5);
        CHECK(mesh.points[4] == glm::vec3(4, 400, float(4.0 / 3)));
        check_cuts(folder, "a.ply", binary(is_big), binary(is_big).size());
    }
}

TEST_CASE("a part has the colour that all its points have")
{
    const TemporaryFolder folder;
    const auto file = [](const char* type, const char* first, const char* last) {
        return sentence(
            "ply\nformat ascii 1.0\ncomment unit cm\ncomment space volume\ncomment group 2 is fine vein\n"
            "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty ",
            type, " red\nproperty ", type, " green\nproperty ", type,
            " blue\nelement face 2\nproperty list uchar int vertex_indices\nproperty uchar group\n"
            "end_header\n0 0 0 ",
            first, "\n1 0 0 ", first, "\n1 1 0 ", first, "\n0 1 0 ", last, "\n3 0 1 2 9\n3 0 2 3 2\n");
    };
    const TriangleMesh mesh = mesh_of(folder, "a.ply", file("uchar", "255 51 0", "255 51 1"));
    REQUIRE(mesh.parts.size() == 2);
    CHECK(mesh.parts[0].name == "group 9");
    CHECK(mesh.parts[0].color == glm::vec3(1.0f, 0.2f, 0.0f));
    CHECK(mesh.parts[1].name == "fine vein");
    CHECK(!mesh.parts[1].color);
    CHECK(mesh.metres == 0.01);
    CHECK(mesh.positions == "volume");
    CHECK(mesh_of(folder, "a.ply", file("float", "1 0.2 -1", "0 0 0")).parts[0].color == glm::vec3(1.0f, 0.2f, 0.0f));
    CHECK(mesh_of(folder, "a.ply", file("ushort", "65535 13107 0", "0 0 0")).parts[0].color ==
          glm::vec3(1.0f, 0.2f, 0.0f));
}

TEST_CASE("a part of PLY ends where the group of the faces changes")
{
    const TemporaryFolder folder;
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty uchar group\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 4 0 1 2 3\n1 3 0 1 2\n0 3 0 1 2\n1 3 1 2 3";
    const TriangleMesh mesh = mesh_of(folder, "a.ply", text);
    REQUIRE(mesh.parts.size() == 3);
    CHECK(mesh.parts[0].end == 3);
    CHECK(mesh.parts[1].name == "group 0");
    CHECK(mesh.parts[1].end == 4);
    CHECK(mesh.parts[2].begin == 4);
    CHECK(mesh.parts[2].end == 5);
    CHECK(contains(refusal_of(folder, "a.ply", changed(text, "\n0 3 0", "\n256 3 0")),
                   ": face 3 has the group 256; expected 0 to 255"));
}

TEST_CASE("damaged PLY is refused with the face, vertex or line")
{
    const TemporaryFolder folder;
    const auto refusal = [&](const std::string& found, const std::string& other) {
        return refusal_of(folder, "a.ply", changed(QUADS, found, other));
    };
    check_cuts(folder, "a.ply", QUADS, QUADS.size() - 1);
    CHECK(contains(refusal("3 1 2 5", "3 1 2 6"), ": face 2 has the corner 6; expected one of the 6 vertices"));
    CHECK(contains(refusal("3 1 2 5", "3 1 2 -1"), ": face 2 has the corner -1; expected one of"));
    CHECK(contains(refusal("3 1 2 5", "3 1 2 0.5"), ": face 2 has the corner 0.5; expected one of"));
    CHECK(contains(refusal("3 1 2 5", "2 1 2"), ": face 2 has 2 corners; expected 3 or more"));
    CHECK(contains(refusal("3 1 2 5", "-3 1 2 5"), "has a list of -3 values; expected a whole number"));
    CHECK(contains(refusal("3 1 2 5", "3 1 two 5"), "a.ply:29: has \"two\"; expected a number"));
    CHECK(contains(refusal("1.5e0", "inf"), ": vertex 4: has a corner with y = inf; expected a finite number"));
    CHECK(contains(refusal("format ascii 1.0", "format ascii 2.0"), "a.ply:2: has a format that is not known"));
    CHECK(contains(refusal("format ascii 1.0\n", ""), "states no format in its header"));
    CHECK(
        contains(refusal("property float x", "property half x"), "a.ply:6: has the type \"half\"; expected one such"));
    CHECK(contains(refusal("property float x", "property float u"), "has no property x of each vertex"));
    CHECK(contains(refusal("property float x", "property list uchar float x"), "has no property x of each vertex"));
    CHECK(
        contains(refusal("list uchar int vertex_index", "list float int vertex_index"), "counts a list by \"float\""));
    CHECK(contains(refusal("int vertex_index", "float vertex_index"), "has no list of corners of each face"));
    CHECK(contains(refusal("element face 2", "element strips 2"), "has no element face; expected vertices and faces"));
    CHECK(contains(refusal("element vertex 6", "element vertex"), "a.ply:5: states an element of no number; expected"));
    CHECK(contains(refusal("element vertex 6", "element vertex 99999999999999999999"),
                   "states an element of \"99999999999999999999\"; expected a name and a number"));
    CHECK(contains(refusal("end_header", "end of header"), "a.ply:20: has \"end of header\"; expected a line of the"));
    CHECK(contains(refusal("face 2", "face 0"), "holds no triangles"));
}

TEST_CASE("counts that the rest of a PLY file cannot hold are refused before anything is allocated")
{
    const TemporaryFolder folder;
    const auto refusal = [&](const std::string& content, const char* found, const char* other) {
        const Effort effort;
        const std::string message = refusal_of(folder, "a.ply", changed(content, found, other));
        CHECK(effort.is_below(AT_ONCE_BYTES));
        return message;
    };
    CHECK(contains(refusal(QUADS, "vertex 6", "vertex 60000000"), "states 60000000 of element \"vertex\", each of at"));
    CHECK(
        contains(refusal(QUADS, "face 2", "face 6000000"), "states 6000000 of element \"face\", each of at least 12"));
    CHECK(contains(refusal(QUADS, "edge 1", "edge 9223372036854775807"), "states 9223372036854775807 of element"));
    CHECK(contains(refusal(binary(true), "vertex 5", "vertex 4000000000"),
                   "states 4000000000 of element \"vertex\", each of at least 18 bytes; expected at most 6, which"));
    const std::string nothing = "element none 4000000000000\nelement vertex";
    CHECK(mesh_of(folder, "a.ply", changed(QUADS, "element vertex", nothing)).triangles.size() == 3);
}
