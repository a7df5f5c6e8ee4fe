#include "engine/tasks/surface_task.h"

#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>

#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Two groups side by side, and a part of group 7 elsewhere.
struct Painted {
    Painted()
    {
        MaskBrickChange change{.brick = 0, .runs = {}};
        for (int64_t y = 3; y < 9; ++y) {
            const size_t row = index_in_brick({4, y, 5});
            change.runs.push_back({uint16_t(row), uint16_t(row + 3), 0, 2});
            change.runs.push_back({uint16_t(row + 4), uint16_t(row + 9), 0, 5});
        }
        mask.apply(change, Direction::forwards);
        const size_t voxel = index_in_brick({0, 0, 0});
        mask.apply({.brick = 1, .runs = {{uint16_t(voxel), uint16_t(voxel), 0, 7}}}, Direction::forwards);
    }
    AnnotationView view() const { return {volume, mask, density, trace, groups}; }

    VolumeInfo volume = annotated_volume();
    Mask mask{volume.size};
    DensityField density = unannotated().density;
    TraceGraph trace;
    Groups groups;
};

std::vector<std::string> names_in(const std::filesystem::path& folder)
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
}

}  // namespace

TEST_CASE("an export of surfaces is given as JSON, and every option is documented")
{
    const auto task =
        from_json<SurfaceTask>(R"({"surface": "a.glb", "groups": "1+4", "smooth": 0, "decimate": 0.25})", "/data", "x");
    CHECK(task.surface == "/data/a.glb");
    CHECK(task.groups == "1+4");
    CHECK(to_json(task, "/data") ==
          R"({"surface":"a.glb","groups":"1+4","smooth":0,"decimate":0.25,"space":"physical","budget_host_mib":0})");
    for (const SessionKey& option : options_of<SurfaceTask>()) CHECK(!option.meaning.empty());
}

TEST_CASE("surfaces are one file for all groups, or one for each where the format holds one")
{
    const Painted painted;
    const auto written = [&](const char* name, const char* groups) {
        const TemporaryFolder folder;
        PlainReporter reporter;
        const SurfaceTask task{.surface = folder.path / name, .groups = groups};
        const SurfaceResult result = run(task, painted.view(), reporter);
        const std::vector<std::string> names = names_in(folder.path);
        CHECK(result.written.size() == names.size());
        return names;
    };
    using Names = std::vector<std::string>;
    CHECK(written("a.ply", "") == Names{"a.ply"});
    CHECK(written("a.GLB", "7+2") == Names{"a.GLB"});
    CHECK(written("a.stl", "") == Names{"a-2.stl", "a-5.stl", "a-7.stl"});
    CHECK(written("a.stl", "7+2") == Names{"a-2.stl", "a-7.stl"});
    CHECK(written("a.stl", "5") == Names{"a.stl"});
}

TEST_CASE("surfaces that cannot be written are refused before any work, in the words of the caller")
{
    const Painted painted;
    const TemporaryFolder folder;
    const auto refusal = [&](const char* name, const char* groups, OptionNames names = OptionNames::keys) {
        const SurfaceTask task{.surface = folder.path / name, .groups = groups, .names = names};
        return error_of([&] { check(task, painted.view()); });
    };
    CHECK(refusal("a.stl", "2").empty());
    CHECK(contains(refusal("a.stl", "2+x"), "groups names the groups \"2+x\"; expected numbers of groups, 1 to 255"));
    CHECK(contains(refusal("a.stl", "0", OptionNames::command_line), "--surface names the groups \"0\""));
    CHECK(contains(refusal("a.stl", "2+3"),
                   "group 3 has no painted voxels, and so no surface; expected one of: 2, 5, 7"));
    CHECK(contains(refusal("a.mesh", ""), "expected a name that ends in one of: .stl, .ply, .obj, .glb"));
    std::filesystem::create_directory(folder.path / "a-5.stl");
    CHECK(contains(refusal("a.stl", ""), "a-5.stl: is a folder"));
    const Mask nothing(painted.mask.size());
    AnnotationView bare{painted.volume, nothing, painted.density, painted.trace, painted.groups};
    CHECK(
        contains(error_of([&] { check(SurfaceTask{.surface = folder.path / "a.ply"}, bare); }), "nothing is painted"));
}

TEST_CASE("surfaces that are cancelled leave the old file, and nothing else, wherever it was")
{
    const Painted painted;
    for (const char* name : {"a.stl", "a.ply", "a.obj", "a.glb"}) {
        const TemporaryFolder folder;
        const SurfaceTask task{.surface = folder.path / name, .groups = "2", .smooth = 2};
        int64_t steps = 0;
        PlainReporter counting([&](double) { ++steps; });
        run(task, painted.view(), counting);
        REQUIRE(steps > 10);
        std::ofstream(task.surface) << "old";
        for (int64_t stop = steps % 3; stop < steps; stop += 3) {
            int64_t step = 0;
            PlainReporter stopping([&](double) {
                if (step++ == stop) throw Stopped("stopped");
            });
            CHECK_THROWS_AS(run(task, painted.view(), stopping), Stopped);
            CHECK(names_in(folder.path) == std::vector<std::string>{name});
            CHECK(bytes_of_file(task.surface) == "old");
        }
    }
}
