#include <limits>

#include <doctest/doctest.h>

#include "tests/unit/formats/meshes/mesh_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

std::string facet(const std::array<glm::vec3, 3>& corners)
{
    std::string text = "  facet normal 0.0e+00 -nan 1\n    outer loop\n";
    for (const glm::vec3& at : corners) text += sentence("      vertex ", at.x, " +", at.y, " ", at.z, "e0\n");
    return text + "    endloop\n  endfacet\n";
}

std::string solid(const std::string& name, const Corners& triangles)
{
    std::string text = "solid " + name + "\n";
    for (const auto& corners : triangles) text += facet(corners);
    return text + "endsolid " + name + "\n";
}

std::string with_crlf(const std::string& text)
{
    std::string changed;
    for (const char letter : text) changed += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
    return changed;
}

}  // namespace

TEST_CASE("binary STL gives the same triangles, with one point where corners are at one position")
{
    const TemporaryFolder folder;
    Corners stored = tetrahedron();
    stored[1][0].x = -0.0f;
    const TriangleMesh mesh = mesh_of(folder, "a.stl", stl_of(stored));
    CHECK(corners_of(mesh) == tetrahedron());
    CHECK(mesh.points.size() == 4);
    REQUIRE(mesh.parts.size() == 1);
    CHECK(mesh.parts[0].name.empty());
    CHECK(!mesh.parts[0].color);
    CHECK(mesh.parts[0].begin == 0);
    CHECK(mesh.parts[0].end == 4);
    CHECK(!mesh.metres);
    CHECK(mesh.positions.empty());
}

// Kind (Meshes): binary STL that begins with the word of text STL
TEST_CASE("binary STL that begins with solid is read as binary, whatever its name")
{
    const TemporaryFolder folder;
    const std::string file = stl_of(tetrahedron(), "solid facet normal of a CAD program");
    CHECK(corners_of(mesh_of(folder, "a.stl", file)) == tetrahedron());
    CHECK(corners_of(mesh_of(folder, "a.data", file)) == tetrahedron());
}

TEST_CASE("many corners of a triangle soup stay apart, and equal ones are joined")
{
    const TemporaryFolder folder;
    Corners soup;
    for (int i = 0; i < 3000; ++i)
        soup.push_back({glm::vec3(3 * i, 0, 0), glm::vec3(3 * i + 1, 0, 0), glm::vec3(0, 1, float(i % 7))});
    const TriangleMesh mesh = mesh_of(folder, "a.stl", stl_of(soup));
    CHECK(corners_of(mesh) == soup);
    CHECK(mesh.points.size() == 2 * 3000 + 7);
}

// Kind (Meshes): text STL with several solids, capitals and line ends of Windows
TEST_CASE("each solid of text STL is a part")
{
    const TemporaryFolder folder;
    const Corners all = tetrahedron();
    const std::string text = solid("the stem", {all[0], all[1]}) + "\n" + solid("", {all[2]}) + solid("vein", {all[3]});
    for (const std::string& content : {text, with_crlf(text), "\xef\xbb\xbf" + text}) {
        const TriangleMesh mesh = mesh_of(folder, "a.txt", content);
        CHECK(corners_of(mesh) == all);
        CHECK(mesh.points.size() == 4);
        REQUIRE(mesh.parts.size() == 3);
        CHECK(mesh.parts[0].name == "the stem");
        CHECK(mesh.parts[1].name.empty());
        CHECK(mesh.parts[2].name == "vein");
        CHECK(mesh.parts[1].begin == 2);
        CHECK(mesh.parts[1].end == 3);
        CHECK(mesh.parts[2].end == 4);
    }
    const std::string capitals =
        "SOLID A\nFACET NORMAL 0 0 1 OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 VERTEX 1 1 0\n"
        "VERTEX 0 1 0 ENDLOOP ENDFACET\nENDSOLID";
    CHECK(mesh_of(folder, "a.stl", capitals).triangles == std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("damaged binary STL is refused")
{
    const TemporaryFolder folder;
    const std::string file = stl_of(tetrahedron());
    const auto with_count = [&](uint32_t count) { return std::string(file).replace(80, 4, raw(count)); };
    check_cuts(folder, "a.stl", file, file.size());
    CHECK(contains(refusal_of(folder, "a.stl", file.substr(0, 100)), "states 4 triangles; expected at most 0, which"));
    CHECK(contains(refusal_of(folder, "a.stl", ""), "has 0 bytes; expected at least 84 of an STL file"));
    CHECK(contains(refusal_of(folder, "a.stl", with_count(3)), "states 3 triangles, but its 284 bytes can hold 4"));
    CHECK(contains(refusal_of(folder, "a.stl", stl_of({})), "holds no triangles; expected at least one"));
    CHECK(contains(refusal_of(folder, "a.stl", with_count(8388609)), "states 8388609 triangles; expected at most 4, "));
    const std::filesystem::path large = folder.write("large.stl", with_count(8388609));
    std::filesystem::resize_file(large, 84 + uintmax_t{50} * 8388609);  // sparse
    CHECK(contains(error_of([&] { static_cast<void>(read_mesh(large, MESH_MEMORY, {})); }),
                   "holds 8388609 triangles; expected at most 8388608: decimate it"));
    Corners triangles = tetrahedron();
    triangles[2][1].y = std::numeric_limits<float>::infinity();
    CHECK(contains(refusal_of(folder, "a.stl", stl_of(triangles)),
                   ": triangle 3: has a corner with y = inf; expected a finite number"));
    CHECK(!is_mesh_file(folder.write("a.data", file.substr(0, 283))));
}

TEST_CASE("damaged text STL is refused with its line")
{
    const TemporaryFolder folder;
    const std::string text = solid("a", tetrahedron());
    check_cuts(folder, "a.stl", text, text.size() - 3);
    const auto refusal = [&](const std::string& found, const std::string& wrong) {
        std::string changed = text;
        return refusal_of(folder, "a.stl", changed.replace(changed.find(found), found.size(), wrong));
    };
    CHECK(contains(refusal("vertex 0", "vertex zero"), "a.stl:4: has \"zero\"; expected a number"));
    CHECK(
        contains(refusal("vertex 0", "vertex 1e39"), "a.stl:4: has a corner with x = 1e+39; expected a finite number"));
    CHECK(contains(refusal("vertex 0", "vertex nan"), "a.stl:4: has a corner with x = nan; expected a finite number"));
    CHECK(contains(refusal("      vertex", "      vertices"), "a.stl:4: has \"vertices\"; expected vertex"));
    CHECK(contains(refusal("outer loop", "inner loop"), "a.stl:3: has \"inner\"; expected outer"));
    CHECK(contains(refusal("endfacet", "endfacets"), "a.stl:8: has \"endfacets\"; expected endfacet"));
    CHECK(contains(refusal("endsolid a", ""), "has the end of the file; expected facet or endsolid"));
    CHECK(contains(refusal_of(folder, "a.stl", "solid a\nendsolid a\n"), "holds no triangles; expected at least one"));
    CHECK(
        contains(refusal_of(folder, "a.stl", text + "facet"), "has \"facet\"; expected solid, or the end of the file"));
}

TEST_CASE("the header of SHVR's STL files states group, unit and space, unless it is cut there")
{
    const TemporaryFolder folder;
    const auto read = [&](const std::string& header) {
        return mesh_of(folder, "a.stl", stl_of(tetrahedron(), header));
    };
    const TriangleMesh mesh = read("SHVR surface, group 7, unit um, positions are physical, in um, along");
    CHECK(mesh.parts[0].name == "group 7");
    CHECK(mesh.metres == 1e-6);
    CHECK(mesh.positions == "physical");
    CHECK(read("SHVR surface, group 7, unit mm, positions are voxels times spacing, in").positions == "volume");
    CHECK(read("SHVR surface, group 7, unit mm").metres == 1e-3);
    CHECK(!read("SHVR surface, group 7, unit voxel, positions are").metres);
    CHECK(!read("a surface, group 7, unit mm").metres);
    const TriangleMesh placed = read("SHVR surface, group 7, SPACE=RAS, space physical, unit mm");
    CHECK(placed.frame == "RAS");
    CHECK(placed.metres == 1e-3);
    CHECK(placed.positions == "physical");
    const std::string start = "SHVR surface, group 7, ";
    CHECK(!read(start + std::string(80 - 2 - 6 - start.size(), 'x') + ", unit m").metres);
}

TEST_CASE("the frame that 3D Slicer states in STL files is read")
{
    const TemporaryFolder folder;
    for (const char* const frame : {"LPS", "RAS"}) {
        const std::string title = sentence("3D Slicer output. SPACE=", frame);
        CHECK(mesh_of(folder, "a.stl", stl_of(tetrahedron(), title)).frame == frame);
        CHECK(mesh_of(folder, "b.stl", solid(title, tetrahedron())).frame == frame);
    }
    CHECK(mesh_of(folder, "a.stl", stl_of(tetrahedron(), "SPACE=LAS")).frame.empty());
    CHECK(mesh_of(folder, "a.stl", stl_of(tetrahedron(), "SPACE=")).frame.empty());
}
