#include <algorithm>

#include <doctest/doctest.h>

#include "engine/formats/meshes/mesh_memory.h"
#include "tests/unit/formats/meshes/mesh_files.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("memory for a mesh is refused before it is taken, with the amounts")
{
    MeshMemory memory("a.stl", 1 << 20);
    std::vector<uint32_t> values;
    memory.make_room(values, 100'000);
    CHECK(values.capacity() == 100'000);
    CHECK(
        contains(error_of([&] { memory.make_room(values, 200'000); }),
                 "a.stl: takes at least 1.14441 MiB of memory to be read; expected at most 1 MiB, which it may take"));
    CHECK(values.capacity() == 100'000);
    CHECK(contains(error_of([&] { memory.take(UINT64_MAX); }), "expected at most 1 MiB"));
    CHECK(contains(error_of([&] { memory.make_room(values, UINT64_MAX / 2); }), "expected at most 1 MiB"));
    memory.take((1 << 20) - 400'000);
    CHECK(contains(error_of([&] { memory.take(1); }), "expected at most 1 MiB"));
    memory.release(1);
    memory.take(1);
}

TEST_CASE("each format keeps to the memory that it may take")
{
    const TemporaryFolder folder;
    constexpr int SIDE = 100;
    Corners triangles;
    std::string obj, faces;
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            triangles.push_back({glm::vec3(x, y, 0), glm::vec3(x + 1, y, 0), glm::vec3(x, y + 1, 0)});
            obj += sentence("v ", x, " ", y, " 0\n");
            faces += "3 0 1 2\n";
        }
    const std::string ply = sentence("ply\nformat ascii 1.0\nelement vertex ", SIDE * SIDE,
                                     "\nproperty float x\nproperty float y\nproperty float z\nelement face ",
                                     SIDE * SIDE, "\nproperty list uchar int vertex_indices\nend_header\n");
    std::string points = obj;
    for (size_t at = points.find('v'); at != std::string::npos; at = points.find('v', at)) points.erase(at, 2);
    for (const auto& [name, content] : std::vector<std::pair<const char*, std::string>>{
             {"a.stl", stl_of(triangles)}, {"a.obj", obj + "f 1 2 3\n"}, {"a.ply", ply + points + faces}}) {
        CHECK(mesh_of(folder, name, content, 4 << 20).points.size() >= SIDE * SIDE);
        CHECK(
            contains(refusal_of(folder, name, content, content.size() + 90'000), "MiB of memory to be read; expected"));
        CHECK(contains(refusal_of(folder, name, content, 10), "MiB of memory to be read; expected at most 0 MiB"));
    }
}

TEST_CASE("a text of too many triangles is read to its end, and its count is stated")
{
    const TemporaryFolder folder;
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const std::string fan = [] {
        std::string corners = "f 1";
        for (int i = 0; i < 100'001; ++i) corners += " 2";
        return corners + "\n";
    }();
    for (int i = 0; i < 84; ++i) text += fan;
    CHECK(contains(refusal_of(folder, "a.obj", text, uint64_t{1} << 30),
                   "holds 8400000 triangles; expected at most 8388608: decimate it"));
}

TEST_CASE("a mesh of too many parts is refused, and names are cut between characters")
{
    const TemporaryFolder folder;
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    std::string parts = points;
    for (int i = 0; i < 65536; ++i) parts += sentence("g ", i, "\nf 1 2 3\n");
    CHECK(mesh_of(folder, "a.obj", parts).parts.size() == 65536);
    CHECK(contains(refusal_of(folder, "a.obj", parts + "g last\nf 1 2 3\n"),
                   "holds more than 65536 parts; expected at most that many: join some of them"));
    std::string name(199, 'x');
    CHECK(mesh_of(folder, "a.obj", points + "g " + name + "\u00e4\u00e4\nf 1 2 3\n").parts[0].name == name);
}

TEST_CASE("progress rises to the end of the file, and a caller can stop the reading")
{
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.write("a.stl", stl_of(Corners(100'000, tetrahedron()[3])));
    std::vector<double> steps;
    static_cast<void>(read_mesh(path, MESH_MEMORY, [&](double fraction) { steps.push_back(fraction); }));
    CHECK(steps.size() >= 4);
    CHECK(std::ranges::is_sorted(steps));
    CHECK(steps.back() == 1.0);
    const auto stop = [](double fraction) {
        if (fraction > 0.5) throw Stopped("stopped");
    };
    CHECK(error_of([&] { static_cast<void>(read_mesh(path, MESH_MEMORY, stop)); }) == "stopped");
}
