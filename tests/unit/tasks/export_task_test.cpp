#include "engine/tasks/export_task.h"

#include <fstream>
#include <set>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_file.h"
#include "engine/jobs/jobs.h"
#include "tests/support/random_annotation.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Some annotation of a small volume, and more of it on request.
struct Annotated {
    explicit Annotated(uint32_t seed) : random(seed)
    {
        for (int i = 0; i < 60; ++i) annotate();
    }
    void annotate()
    {
        for (const Change& change : random_command(document, random).changes)
            apply(document, change, Direction::forwards);
    }
    AnnotationView view() const
    {
        return {.volume = volume,
                .mask = document.mask,
                .density = document.density,
                .trace = document.trace,
                .groups = groups};
    }
    std::mt19937 random;
    VolumeInfo volume = annotated_volume();
    Document document = unannotated();
    Groups groups;
};

ExportTask task_in(const std::filesystem::path& folder)
{
    return {.mask = folder / "a.mask",
            .offset = folder / "a.offset",
            .trace = folder / "a.graphml",
            .mesh = folder / "a.ply",
            .metrics = folder / "a.csv"};
}

std::map<std::string, std::string> files_of(const std::filesystem::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        files[entry.path().filename().string()] = bytes_of_file(entry.path());
    return files;
}

}  // namespace

TEST_CASE("an export is given as JSON, and unknown options are refused by name")
{
    const auto task =
        from_json<ExportTask>(R"({"mask": "out.tif", "space": "volume", "ome_zarr": "0.5"})", "/data", "x");
    CHECK(task.mask == "/data/out.tif");
    CHECK(task.space == Positions::volume);
    CHECK(task.version == OmeZarrVersion::v0_5);
    CHECK(task.trace.empty());
    CHECK(
        to_json(task, "/data") ==
        R"({"mask":"out.tif","labels":false,"ome_zarr":"0.5","break_loops":false,"space":"volume","smooth":20,"decimate":1.0})");
    CHECK(from_json<ExportTask>(to_json(ExportTask{}, "/"), "/", "x").version == std::nullopt);
    const auto refusal = [](const char* text) {
        return error_of([&] { static_cast<void>(from_json<ExportTask>(text, "/", "line 3")); });
    };
    CHECK(contains(refusal(R"({"masc": "a"})"), "line 3: unknown key masc; expected one of: mask, labels, ome_zarr"));
    CHECK(contains(refusal(R"({"space": "voxels"})"), "key space is \"voxels\"; expected"));
    CHECK(contains(refusal(R"({"labels": 1})"), "key labels is 1"));
    CHECK(contains(refusal("[]"), "line 3"));
}

TEST_CASE("an export writes surfaces, and states what they replace")
{
    const TemporaryFolder folder;
    const VolumeInfo volume = annotated_volume();
    Document document = unannotated();
    const auto voxel = uint16_t(index_in_brick({3, 3, 3}));
    document.mask.apply({.brick = 0, .runs = {{voxel, voxel, 0, 2}}}, Direction::forwards);
    const AnnotationView view{volume, document.mask, document.density, document.trace, {}};
    PlainReporter reporter;
    ExportTask task{.mask = folder.path / "a.mask", .surface = folder.path / "a.stl", .smooth = 0};
    CHECK(replaced_files(task).empty());
    const ExportResult result = run(task, view, reporter);
    CHECK(result.written ==
          std::vector<std::string>{(folder.path / "a.mask").string(), (folder.path / "a-2.stl").string()});
    CHECK(std::filesystem::file_size(folder.path / "a-2.stl") == 84 + 12 * 50);
    CHECK(replaced_files(task) == std::vector<std::filesystem::path>{task.mask, folder.path / "a-2.stl"});
    task.surface_groups = "2";
    CHECK(replaced_files(task) == std::vector<std::filesystem::path>{task.mask});
    task.surface_groups = "3";
    CHECK(contains(error_of([&] { check(task, view); }), "group 3 has no painted voxels"));
    task.surface_groups = "2x";
    CHECK(contains(error_of([&] { check(task); }), "surface_groups names the groups \"2x\""));
    task.surface_groups = "";
    task.surface = task.mask;
    CHECK(contains(error_of([&] { check(task); }), "mask and surface are both"));
}

TEST_CASE("every option of an export is documented")
{
    std::set<std::string> names;
    for (const SessionKey& option : options_of<ExportTask>()) {
        names.insert(option.name);
        CHECK(!option.meaning.empty());
        CHECK(!option.allowed.empty());
        CHECK(!option.standard.empty());
    }
    CHECK(names == std::set<std::string>{"mask", "labels", "ome_zarr", "offset", "trace", "break_loops", "mesh",
                                         "space", "metrics", "measurements", "sections", "axis", "surface",
                                         "surface_groups", "smooth", "decimate"});
}

TEST_CASE("patterns of flower heads follow the measures where sections are stated, named or in use")
{
    const TemporaryFolder folder;
    VolumeInfo volume = annotated_volume();
    Document document = unannotated();
    Groups groups;
    PlainReporter reporter;
    const auto node = [&](uint32_t number, uint8_t group) {
        document.trace.apply(TraceNodeChange{number, {}, TraceNode{{2.0 + number % 3, 1.0 + number, 2.0}, 1.0, group}},
                             Direction::forwards);
    };
    for (uint32_t i = 0; i < 5; ++i) node(i, 1);
    const auto rows = [&](const std::string& sections) {
        const ExportTask task{.metrics = folder.path / "a.csv", .sections = sections};
        run(task, {volume, document.mask, document.density, document.trace, groups}, reporter);
        return bytes_of_file(task.metrics);
    };
    const std::string plain = rows("");
    CHECK(!contains(plain, "pattern"));  // group 1 alone is any trace
    CHECK(rows("abaxial=1").starts_with(plain + "pattern,,,"));
    groups[1].name = "stem";
    CHECK(contains(rows(""), "pattern,,,stage_a,1,1\r\n"));
    groups.clear();
    node(5, 2);
    CHECK(contains(rows(""), "pattern,,,stage_a,0,1\r\n"));
    groups[2].parent = 3;
    CHECK(contains(rows("abaxial=1,floret=3"), "pattern,,,florets,1,1\r\n"));
}

TEST_CASE("sections and an axis are refused without measures, and where they are malformed")
{
    const auto refusal = [](ExportTask task) {
        task.names = OptionNames::command_line;
        return error_of([&] { check(task); });
    };
    CHECK(contains(refusal({.sections = "adaxial=2"}), "--sections is 'adaxial=2' but --metrics is not given"));
    CHECK(contains(refusal({.axis = "1,2,3,0,0,1"}), "--axis is '1,2,3,0,0,1' but --metrics is not given"));
    CHECK(contains(refusal({.metrics = "a.csv", .axis = "1,2,3"}), "found 3 numbers; expected six"));
    CHECK(
        contains(refusal({.metrics = "a.csv", .sections = "adaxial=two"}), "found 'two'; expected a group, 1 to 255"));
}

TEST_CASE("what an export would replace can be asked before")
{
    const TemporaryFolder folder;
    ExportTask task = task_in(folder.path);
    CHECK(replaced_files(task).empty());
    std::ofstream(task.trace) << "of another scan";
    CHECK(replaced_files(task) == std::vector<std::filesystem::path>{task.trace});
}

TEST_CASE("names and folders are refused before anything is written, in the words of the caller")
{
    const TemporaryFolder folder;
    const Annotated annotated(1);
    PlainReporter reporter;
    const auto refusal = [&](ExportTask task) {
        task.names = OptionNames::command_line;
        const std::string of_check = error_of([&] { check(task, annotated.view()); });
        const std::string of_run = error_of([&] { run(task, annotated.view(), reporter); });
        CHECK(of_check == of_run);
        CHECK(files_of(folder.path).empty());
        return of_check;
    };
    ExportTask task = task_in(folder.path);
    task.metrics = folder.path / "a.txt";
    CHECK(refusal(task) ==
          sentence("--metrics is '", task.metrics.string(), "'; expected a name that ends in one of: .csv"));
    CHECK_THROWS_AS(check(task), UsageError);
    CHECK(error_of([&] { check(task); }).starts_with("metrics is '"));
    task = task_in(folder.path);
    task.mask = folder.path / "a.jpg";
    CHECK(contains(refusal(task), "--mask is '"));
    task = task_in(folder.path);
    task.mesh = folder.path / "none" / "a.obj";
    CHECK(contains(refusal(task), "there is no folder"));
    {
        const TemporaryFolder other;
        std::ofstream(other.path / "taken") << "a file";
        task.mesh = other.path / "taken" / "a.obj";
        CHECK(contains(refusal(task), "taken is a file; expected a folder"));
    }
    task = task_in(folder.path);
    task.mask = folder.path / (std::string(300, 'x') + ".mask");
    CHECK(contains(refusal(task), "is too long, with 305 bytes; expected at most "));
    task.mask = folder.path / (std::string(300, 'x') + ".zarr");
    CHECK(contains(refusal(task), "is too long, with 305 bytes; expected at most "));
    task = task_in(folder.path);
    task.labels = true;
    CHECK(contains(refusal(task), "is no project folder; expected one, to write --labels into, or --mask with a name"));
    task.labels = false;
    const Document nothing = unannotated();
    AnnotationView bare{annotated.volume, nothing.mask, nothing.density, nothing.trace, annotated.groups};
    CHECK(error_of([&] { check(task, bare); }) == "the session: names no trace; expected the key annotation.trace");
    bare.trace_path = folder.path / "b.graphml";
    CHECK(contains(error_of([&] { check(task, bare); }),
                   "b.graphml: does not exist: nothing is traced; expected the trace"));
}

TEST_CASE("an export writes what is there and counts it")
{
    const TemporaryFolder folder;
    const Annotated annotated(2);
    PlainReporter reporter;
    std::vector<std::string> told;
    const ExportTask task = task_in(folder.path);
    const ExportResult result = run(task, annotated.view(), reporter, [&](const ExportResult& so_far) {
        told.push_back(so_far.written.back());
        CHECK(std::filesystem::exists(told.back()));
    });
    CHECK(result.written == told);
    CHECK(result.written == std::vector<std::string>{task.trace, task.mask, task.offset, task.mesh, task.metrics});
    Mask read(annotated.document.mask.size());
    for (const MaskBrickChange& change : load_mask(task.mask, read.size())) read.apply(change, Direction::forwards);
    CHECK(hash_of(read) == hash_of(annotated.document.mask));
    const TraceFile trace = load_trace(task.trace, space_of(annotated.volume));
    CHECK(trace.trace == annotated.document.trace);
    CHECK(result.nodes == trace.trace.nodes().size());
    CHECK(result.internodes == trace.trace.internodes().size());
    int64_t painted = 0;
    for (const auto& [group, voxels] : result.voxels_by_group) painted += voxels;
    CHECK(painted > 0);
    CHECK(painted == voxel_count(annotated.volume) - annotated.document.mask.voxels_by_group()[0]);
    CHECK(result.unit == annotated.volume.unit);
}

TEST_CASE("a snapshot is exported by a job as it was, while a person goes on")
{
    const TemporaryFolder before, after;
    Annotated annotated(3);
    PlainReporter reporter;
    run(task_in(before.path), annotated.view(), reporter);
    const auto snapshot = std::make_shared<const AnnotationSnapshot>(annotated.view());
    Jobs jobs;
    for (int i = 0; i < 5; ++i)
        jobs.start("exporting", [snapshot, &after](ProgressReporter& told) -> Jobs::Completion {
            run(task_in(after.path), snapshot->view(), told);
            return {};
        });
    for (int i = 0; i < 2000 || jobs.states().size() > 2; ++i) annotated.annotate();
    for (const Jobs::Finished& finished : jobs.wait()) CHECK(finished.failure == "");
    CHECK(files_of(after.path) == files_of(before.path));
    CHECK(hash_of(annotated.document.mask) != hash_of(snapshot->view().mask));
}

TEST_CASE("an export that is cancelled leaves no file half written, wherever it was")
{
    const Annotated annotated(4);
    std::map<std::string, std::string> complete;
    int64_t steps = 0;
    {
        const TemporaryFolder folder;
        PlainReporter reporter([&](double) { ++steps; });
        run(task_in(folder.path), annotated.view(), reporter);
        complete = files_of(folder.path);
    }
    REQUIRE(steps > 3);
    for (int64_t stop = 0; stop < steps; ++stop) {
        const TemporaryFolder folder;
        int64_t step = 0;
        PlainReporter reporter([&](double) {
            if (step++ == stop) throw Stopped("stopped");
        });
        CHECK_THROWS_AS(run(task_in(folder.path), annotated.view(), reporter), Stopped);
        for (const auto& [name, content] : files_of(folder.path)) {
            REQUIRE(complete.contains(name));
            CHECK(content == complete.at(name));
        }
    }
}
