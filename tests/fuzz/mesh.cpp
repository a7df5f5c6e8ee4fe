// A mesh, found by its content: as a.obj, or else as a.stl. A mesh that opens is checked against the guarantees of
// mesh_file.h; a small one is written as PLY and OBJ, and read again.

#include "engine/base/finite.h"
#include "engine/formats/export/surface_export.h"
#include "engine/formats/meshes/mesh_file.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

namespace {

using namespace shvr;
using namespace shvr::fuzz;

constexpr uint64_t MEMORY = uint64_t{32} << 20;
constexpr size_t MAX_TRIANGLES_WRITTEN = 1000;

void check(const TriangleMesh& mesh)
{
    expect(!mesh.triangles.empty() && mesh.triangles.size() <= MAX_MESH_TRIANGLES, "no triangles, or too many");
    for (const glm::vec3& point : mesh.points) expect(is_finite(glm::dvec3(point)), "a point that is not finite");
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            expect(triangle[corner] < mesh.points.size(), "a corner without a point");
    uint32_t end = 0;
    for (const MeshPart& part : mesh.parts) {
        expect(part.begin == end && part.end > part.begin, "parts that do not cover the triangles in order");
        expect(part.name.size() <= 200, "a long name");
        for (const char letter : part.name) expect(static_cast<unsigned char>(letter) >= 0x20, "a control character");
        if (part.color)
            for (int i = 0; i < 3; ++i)
                expect((*part.color)[i] >= 0.0f && (*part.color)[i] <= 1.0f, "a colour out of range");
        end = part.end;
    }
    expect(end == mesh.triangles.size(), "triangles without a part");
    expect(!mesh.metres || (*mesh.metres > 0.0 && *mesh.metres <= 1.0), "a unit that is no length");
    expect(mesh.positions.empty() || mesh.positions == "physical" || mesh.positions == "volume", "an unknown space");
}

/// A mesh that was read, as one part.
class ReadSurface final : public SurfaceParts {
public:
    explicit ReadSurface(const TriangleMesh& mesh) : mesh_(mesh)
    {
        parts = {{.group = 1, .name = "a", .vertices = mesh.points.size(), .triangles = mesh.triangles.size()}};
    }
    void for_each_vertex(const SurfacePart&, const VisitVertex& visit, const Progress&) override
    {
        for (const glm::vec3& point : mesh_.points) visit(point);
    }
    void for_each_triangle(const SurfacePart&, const VisitTriangle& visit, const Progress&) override
    {
        for (const glm::uvec3& triangle : mesh_.triangles)
            visit(triangle, {mesh_.points[triangle.x], mesh_.points[triangle.y], mesh_.points[triangle.z]});
    }

private:
    const TriangleMesh& mesh_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    const InputFolder& folder = input_folder();
    folder.clear();
    auto file = folder.write("a.obj", text_of({data, size}));
    if (!is_mesh_file(file)) file = folder.write("a.stl", text_of({data, size}));
    TriangleMesh mesh;
    if (!accepts([&] { mesh = read_mesh(file, MEMORY, {}); })) return 0;
    expect(is_mesh_file(file), "a mesh that is not recognised");
    check(mesh);
    if (mesh.triangles.size() > MAX_TRIANGLES_WRITTEN || mesh.points.size() > MAX_TRIANGLES_WRITTEN) return 0;
    ReadSurface surface(mesh);
    for (const char* const name : {"b.ply", "b.obj"}) {
        export_surfaces(folder.path() / name, surface, {});
        const TriangleMesh again = read_mesh(folder.path() / name, MEMORY, {});
        expect(again.points == mesh.points && again.triangles == mesh.triangles, "a mesh that a format does not keep");
    }
    return 0;
}
