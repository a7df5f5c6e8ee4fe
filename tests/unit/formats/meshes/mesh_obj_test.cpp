#include <doctest/doctest.h>

#include "tests/unit/formats/meshes/mesh_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const std::string SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const std::vector<glm::uvec3> TWO_TRIANGLES{{0, 1, 2}, {0, 2, 3}};

}  // namespace

// Kind (Meshes): corners of OBJ as 1, 1/2, 1//3, 1/2/3 and counted backwards
TEST_CASE("every way to write a face of OBJ gives the same triangles")
{
    const TemporaryFolder folder;
    for (const char* const face :
         {"f 1 2 3 4", "f 1/1 2/1 3/1 4/2\n", "f 1//1 2//1 3//1 4//1\r\n", "f\t1/1/1  2/1/1\t3/1/1 4/1/1 \n",
          "f -4 -3 -2 -1", "f -4//-1 2//1 -2/7 4", "f 1 2 \\\n  3 4", "f 1 2 3\\\r\n4\n", "f 1 2 3 4 # the square",
          "f 1 2 3\nf 1 3 4\n", "f +1 2 3 4"}) {
        const TriangleMesh mesh = mesh_of(folder, "a.obj", SQUARE + "vt 0 0\nvn 0 0 1\n" + face);
        CHECK_MESSAGE(mesh.triangles == TWO_TRIANGLES, face);
        CHECK(mesh.points.size() == 4);
    }
    CHECK(mesh_of(folder, "a.OBJ", "f 1 2 3 4\n" + SQUARE).triangles == TWO_TRIANGLES);
    CHECK(mesh_of(folder, "a.obj", "\xef\xbb\xbf" + SQUARE + "f 1 2 3 4").triangles == TWO_TRIANGLES);
}

TEST_CASE("weights, colours and statements about anything but triangles are passed over")
{
    const TemporaryFolder folder;
    const TriangleMesh mesh = mesh_of(folder, "a.obj",
                                      "# Blender\r\n\r\nmtllib a.mtl\r\nv 0 0 0 1.0\r\nv 1 0 0 1 0.5 0.5\r\n"
                                      "v 1e0 +1.0 -0\r\nvp 1\r\nusemtl red\r\ns off\r\nl 1 2\r\np 1\r\n  f 1 2 3\r\n");
    CHECK(mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}});
    CHECK(mesh.points == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
    CHECK(!mesh.metres);
}

TEST_CASE("groups and objects of OBJ are parts, under the names of SHVR's comments")
{
    const TemporaryFolder folder;
    const TriangleMesh mesh =
        mesh_of(folder, "a.obj",
                "# SHVR trace as tubes, unit inch\n# space physical\n# group 3 is the \x1b[1m vein\n" + SQUARE +
                    "f 1 2 3\no cube\ng empty\ng group_3\nf 1 2 3\nf 1 3 4\ng group_4\nf 1 2 4\ng group_4\nf 2 3 4\n");
    REQUIRE(mesh.parts.size() == 3);
    CHECK(mesh.parts[0].name.empty());
    CHECK(mesh.parts[0].end == 1);
    CHECK(mesh.parts[1].name == "the ?[1m vein");
    CHECK(mesh.parts[1].end == 3);
    CHECK(mesh.parts[2].name == "group_4");
    CHECK(mesh.parts[2].begin == 3);
    CHECK(mesh.parts[2].end == 5);
    CHECK(mesh.metres == doctest::Approx(0.0254).epsilon(1e-12));
    CHECK(mesh.positions == "physical");
}

TEST_CASE("damaged OBJ is refused with its line")
{
    const TemporaryFolder folder;
    const auto refusal = [&](const std::string& end) { return refusal_of(folder, "a.obj", SQUARE + end); };
    const std::string expected = "; expected the number of a vertex, of which the file has 4";
    CHECK(contains(refusal("f 1 2 3\nf 1 2 5\n"), "a.obj:6: has the corner \"5\"" + expected));
    CHECK(contains(refusal("f 1 2 0"), "a.obj:5: has the corner \"0\"" + expected));
    CHECK(contains(refusal("f 1 2 -5"), "a.obj:5: has the corner \"-5\"" + expected));
    CHECK(contains(refusal("f 1 2 x"), "a.obj:5: has the corner \"x\"" + expected));
    CHECK(contains(refusal("f 1 2 4294967296"), "a.obj:5: has the corner \"4294967296\"" + expected));
    CHECK(contains(refusal("f 1 2 4294967295"), "a.obj:5: has the corner \"4294967295\"" + expected));
    CHECK(contains(refusal("f 1 2"), "a.obj:5: has a face of 2 corners; expected 3 or more"));
    CHECK(contains(refusal("f 1 2 \\"), "a.obj:5: has a face of 2 corners; expected 3 or more"));
    CHECK(contains(refusal("v 1 2\nf 1 2 3"), "a.obj:5: ends too early; expected a number"));
    CHECK(contains(refusal("v 1 2,5 3"), "a.obj:5: has \"2,5\"; expected a number"));
    CHECK(contains(refusal("v 1 nan 3"), "a.obj:5: has a corner with y = nan; expected a finite number"));
    CHECK(contains(refusal("v 1 2 -1e300"), "a.obj:5: has a corner with z = -1e+300; expected a finite number"));
    CHECK(contains(refusal("l 1 2"), "holds no triangles; expected at least one"));
    CHECK(contains(refusal("#" + std::string(size_t{2} << 20, 'x')), "a.obj:5: is longer than 1048576 bytes"));
}

TEST_CASE("a file named .obj is a mesh only if its lines are of OBJ")
{
    const TemporaryFolder folder;
    CHECK(is_mesh_file(folder.write("a.obj", "# cube\n\n  vn 0 0 1\n")));
    CHECK(!is_mesh_file(folder.write("a.obj", "# cube\n")));
    CHECK(!is_mesh_file(folder.write("a.obj", std::string("v 0 0 0\0\n", 9))));
    CHECK(!is_mesh_file(folder.write("a.txt", SQUARE + "f 1 2 3")));
    CHECK(!is_mesh_file(folder.write("a.obj", "")));
    CHECK(!is_mesh_file(folder.path / "missing.obj"));
    CHECK(!is_mesh_file(folder.path));
    CHECK(contains(refusal_of(folder, "a.txt", SQUARE), ": begins like no mesh that can be read; expected STL, PLY,"));
    CHECK(contains(error_of([&] { static_cast<void>(read_mesh(folder.path, MESH_MEMORY, {})); }),
                   ": is not a regular file; expected a file of a mesh"));
    CHECK(contains(error_of([&] { static_cast<void>(read_mesh(folder.path / "b.obj", MESH_MEMORY, {})); }),
                   "b.obj: cannot be opened: No such file"));
}
