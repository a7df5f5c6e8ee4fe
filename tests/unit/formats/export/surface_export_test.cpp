#include "engine/formats/export/surface_export.h"

#include <fstream>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A surface that states a size and has no vertices.
class StatedSurface final : public SurfaceParts {
public:
    StatedSurface(uint64_t vertices, uint64_t triangles)
    {
        parts = {{.group = 1, .name = "stem", .vertices = vertices, .triangles = triangles}};
    }
    void for_each_vertex(const SurfacePart&, const VisitVertex&, const Progress&) override {}
    void for_each_triangle(const SurfacePart&, const VisitTriangle&, const Progress&) override {}
};

}  // namespace

TEST_CASE("a surface that is too large for the format or the disk is refused, and the old file stays")
{
    const TemporaryFolder folder;
    const auto refusal = [&](const char* name, uint64_t vertices, uint64_t triangles) {
        const std::filesystem::path path = folder.path / name;
        std::ofstream(path) << "old";
        StatedSurface surface(vertices, triangles);
        const std::string message = error_of([&] { export_surfaces(path, surface, {}); });
        CHECK(contains(message, name));
        CHECK(bytes_of_file(path) == "old");
        return message;
    };
    constexpr uint64_t LARGE = uint64_t{1} << 50;
    CHECK(contains(refusal("a.stl", 9, LARGE), "triangles; expected at most 4294967295: use .ply"));
    CHECK(contains(refusal("a.ply", LARGE, 9), "vertices; expected at most 4294967295: write fewer groups"));
    CHECK(contains(refusal("a.glb", 9, uint64_t{1} << 29), "bytes; expected at most 4294967295, which .glb allows"));
    const std::string space = "the free space of its disk: free some of it, or write fewer groups";
    CHECK(contains(refusal("a.ply", 9, LARGE), space));
    CHECK(contains(refusal("a.obj", LARGE, 9), space));
}
