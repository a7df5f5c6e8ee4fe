#include <doctest/doctest.h>

#include "engine/annotation/trace/trace_mesh.h"
#include "engine/annotation/trace/trace_space.h"
#include "engine/base/image.h"
#include "engine/formats/export/surface_export.h"
#include "engine/volume/unit.h"
#include "tests/unit/formats/meshes/mesh_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Two tetrahedra of different sizes near an origin, as `shvr export --surface` has them.
class TwoSurfaces final : public SurfaceParts {
public:
    TwoSurfaces(const TraceSpace& space, Positions positions)
    {
        parts = {{.group = 3, .name = "stem, fine", .color = {1.0, 0.25, 0.0}, .vertices = 4, .triangles = 4},
                 {.group = 7, .name = "vein", .color = {0.0, 0.5, 1.0}, .vertices = 4, .triangles = 4}};
        comments = {"unit " + space.unit, in_words(space, positions)};
        for (const auto& [name, value] : statements_of(space, positions)) comments.push_back(name + (" " + value));
        if (positions == Positions::physical) comments.push_back("SPACE=" + space.frame);
        if (positions == Positions::physical) origin = space.origin;
        if (const auto micrometres = micrometres_in(space.unit)) metres = 1e-6 * *micrometres;
    }
    void keep_one_part() { parts.pop_back(); }

    glm::dvec3 vertex(const SurfacePart& part, uint32_t index) const
    {
        return origin + glm::dvec3(TETRAHEDRON[index]) * (part.group == 3 ? 0.1 : 0.7);
    }
    void for_each_vertex(const SurfacePart& part, const VisitVertex& visit, const Progress&) override
    {
        for (uint32_t i = 0; i < 4; ++i) visit(vertex(part, i));
    }
    void for_each_triangle(const SurfacePart& part, const VisitTriangle& visit, const Progress&) override
    {
        for (const glm::uvec3& face : TETRAHEDRON_FACES)
            visit(face, {vertex(part, face.x), vertex(part, face.y), vertex(part, face.z)});
    }
};

const TraceSpace MILLIMETRES{.size = {4, 5, 6},
                             .unit = "mm",
                             .directions = {{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
                             .origin = {100.3, -20.7, 3.14159},
                             .frame = "LPS"};

TriangleMesh written_and_read(const TemporaryFolder& folder, const char* name, TwoSurfaces& surfaces)
{
    const std::filesystem::path path = folder.path / name;
    export_surfaces(path, surfaces, {});
    CHECK(is_mesh_file(path));
    return read_mesh(path, MESH_MEMORY, {});
}

/// Checks all that each format keeps.
void check_same(const TriangleMesh& mesh, const TwoSurfaces& surfaces)
{
    REQUIRE(mesh.points.size() == 4 * surfaces.parts.size());
    REQUIRE(mesh.parts.size() == surfaces.parts.size());
    std::vector<glm::uvec3> expected;
    for (uint32_t part = 0; part < mesh.parts.size(); ++part) {
        for (const glm::uvec3& face : TETRAHEDRON_FACES) expected.push_back(face + 4 * part);
        CHECK(mesh.parts[part].begin == 4 * part);
        CHECK(mesh.parts[part].end == 4 * part + 4);
    }
    CHECK(mesh.triangles == expected);
}

/// Checks the place of the volume that the file states.
void check_place(const TriangleMesh& mesh, Positions positions)
{
    const bool is_physical = positions == Positions::physical;
    CHECK(mesh.positions == (is_physical ? "physical" : "volume"));
    CHECK(mesh.frame == (is_physical ? "LPS" : ""));
    REQUIRE(mesh.origin.has_value() == is_physical);
    REQUIRE(mesh.directions.has_value() == is_physical);
    if (!is_physical) return;
    const double unit = 1e-3 / mesh.metres.value();
    for (int axis = 0; axis < 3; ++axis)
        CHECK((*mesh.origin)[axis] == doctest::Approx(unit * MILLIMETRES.origin[axis]).epsilon(1e-12));
    CHECK(*mesh.directions == MILLIMETRES.directions);
}

}  // namespace

TEST_CASE("PLY and OBJ of SHVR are read back equal")
{
    const TemporaryFolder folder;
    for (const Positions positions : {Positions::physical, Positions::volume}) {
        TwoSurfaces surfaces(MILLIMETRES, positions);
        for (const char* const name : {"a.ply", "a.obj"}) {
            const TriangleMesh mesh = written_and_read(folder, name, surfaces);
            check_same(mesh, surfaces);
            for (uint32_t part = 0; part < 2; ++part) {
                CHECK(mesh.parts[part].name == surfaces.parts[part].name);
                for (uint32_t i = 0; i < 4; ++i)
                    CHECK(mesh.points[4 * part + i] == glm::vec3(surfaces.vertex(surfaces.parts[part], i)));
            }
            CHECK(mesh.metres == 1e-3);
            check_place(mesh, positions);
        }
        const TriangleMesh ply = read_mesh(folder.path / "a.ply", MESH_MEMORY, {});
        CHECK(ply.parts[0].color == glm::vec3(255, 137, 0) / 255.0f);
        CHECK(ply.parts[1].color == glm::vec3(0, 188, 255) / 255.0f);
    }
}

TEST_CASE("binary glTF of SHVR is read back at its origin, in metres")
{
    const TemporaryFolder folder;
    for (const Positions positions : {Positions::physical, Positions::volume}) {
        TwoSurfaces surfaces(MILLIMETRES, positions);
        const TriangleMesh mesh = written_and_read(folder, "a.glb", surfaces);
        check_same(mesh, surfaces);
        for (uint32_t part = 0; part < 2; ++part) {
            const SurfacePart& stored = surfaces.parts[part];
            CHECK(mesh.parts[part].name == stored.name);
            for (int i = 0; i < 3; ++i) CHECK(mesh.parts[part].color.value()[i] == float(srgb_encode(stored.color[i])));
            for (uint32_t i = 0; i < 4; ++i) {
                const glm::dvec3 offset(glm::vec3(surfaces.vertex(stored, i) - surfaces.origin));
                const glm::dvec3 metres = 1e-3 * offset + 1e-3 * surfaces.origin;
                CHECK(mesh.points[4 * part + i] == glm::vec3(metres));
            }
        }
        CHECK(mesh.metres == 1.0);
        check_place(mesh, positions);
    }
}

TEST_CASE("STL of SHVR is read back equal, with the points that its corners share")
{
    const TemporaryFolder folder;
    for (const Positions positions : {Positions::physical, Positions::volume}) {
        TwoSurfaces surfaces(MILLIMETRES, positions);
        surfaces.keep_one_part();
        const TriangleMesh mesh = written_and_read(folder, "a.stl", surfaces);
        CHECK(mesh.points.size() == 4);
        Corners expected;
        surfaces.for_each_triangle(surfaces.parts[0],
                                   [&](const glm::uvec3&, const std::array<glm::dvec3, 3>& at) {
                                       expected.push_back({glm::vec3(at[0]), glm::vec3(at[1]), glm::vec3(at[2])});
                                   },
                                   {});
        CHECK(corners_of(mesh) == expected);
        REQUIRE(mesh.parts.size() == 1);
        CHECK(mesh.parts[0].name == "group 3");
        CHECK(mesh.metres == 1e-3);
        CHECK(mesh.positions == (positions == Positions::physical ? "physical" : "volume"));
        CHECK(mesh.frame == (positions == Positions::physical ? "LPS" : ""));
    }
}

TEST_CASE("where the unit is no length, no format states one")
{
    const TemporaryFolder folder;
    TwoSurfaces surfaces({.size = {4, 5, 6}}, Positions::volume);
    surfaces.keep_one_part();
    for (const char* const name : {"a.stl", "a.ply", "a.obj", "a.glb"}) {
        const TriangleMesh mesh = written_and_read(folder, name, surfaces);
        CHECK(!mesh.metres);
        CHECK(mesh.positions == "volume");
        CHECK(mesh.points[mesh.triangles[3].z] == glm::vec3(surfaces.vertex(surfaces.parts[0], 3)));
    }
}

TEST_CASE("tubes of a trace are read back, with unit and space")
{
    const TemporaryFolder folder;
    TraceGraph trace;
    trace.apply(TraceNodeChange{1, {}, TraceNode{.position = {1, 2, 3}, .radius = 0.5, .group = 4}},
                Direction::forwards);
    const TracePart ball = mesh_of(trace.node(1));
    for (const char* const name : {"a.ply", "a.obj"}) {
        save_trace_mesh(folder.path / name, trace, MILLIMETRES, Positions::volume);
        const TriangleMesh mesh = read_mesh(folder.path / name, MESH_MEMORY, {});
        CHECK(mesh.triangles == ball.triangles);
        REQUIRE(mesh.points.size() == ball.vertices.size());
        for (size_t i = 0; i < mesh.points.size(); ++i) CHECK(mesh.points[i] == glm::vec3(ball.vertices[i]));
        CHECK(mesh.metres == 1e-3);
        CHECK(mesh.positions == "volume");
    }
}
