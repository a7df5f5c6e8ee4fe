// Importing, labelling, describing and evaluating, as functions.

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "engine/tasks/describe_task.h"
#include "engine/tasks/evaluate_task.h"
#include "engine/tasks/import_task.h"
#include "engine/tasks/label_task.h"
#include "tests/support/sparse_zarr.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Records the reports that it receives, and cancels at a given call.
class Listener final : public ProgressReporter {
public:
    explicit Listener(int64_t stop_at = -1) : stop_at_(stop_at) {}
    Progress begin(const std::string& what) override
    {
        stretches.push_back(what);
        return [this](double fraction) {
            fractions.push_back(fraction);
            if (int64_t(fractions.size()) == stop_at_) {
                is_stopped = true;
                throw Stopped("stopped");
            }
        };
    }
    void show(double fraction, const std::string&, double) override { fractions.push_back(fraction); }
    const std::atomic<bool>& stop_requested() const override { return is_stopped; }

    std::vector<std::string> stretches;
    std::vector<double> fractions;
    std::atomic<bool> is_stopped = false;

private:
    int64_t stop_at_;
};

/// 5 x 4 x 3 voxels.
const std::filesystem::path CHIRALITY_NRRD = CHIRALITY / "attached.nrrd";

template <class Task>
void check_documented()
{
    for (const SessionKey& option : options_of<Task>()) {
        CAPTURE(option.name);
        CHECK(!option.meaning.empty());
        CHECK(!option.standard.empty());
    }
}

}  // namespace

TEST_CASE("every option of every task is documented with its default")
{
    check_documented<ImportTask>();
    check_documented<LabelTask>();
    check_documented<EvaluateTask>();
    check_documented<DescribeTask>();
}

TEST_CASE("options of tasks are the same after JSON")
{
    ImportTask import{.volume = "/a/b.nrrd",
                      .project = "/a/c",
                      .crop = VoxelBox{{1, 2, 3}, {4, 5, 6}},
                      .reverse = true,
                      .blur_voxels = {0.5, 1.0, 2.0},
                      .downscale = 3,
                      .raw = "5x4x3:uint8",
                      .choice = {.channel = "red", .spacing = glm::dvec3(0.1, 0.2, 0.3), .unit = "um"},
                      .version = OmeZarrVersion::v0_5,
                      .overwrite = true,
                      .threads = 2};
    const std::string text = to_json(import, "/a");
    CHECK(contains(text, R"("volume":"b.nrrd")"));
    CHECK(contains(text, R"("crop":{"lower":[1,2,3],"upper":[4,5,6]})"));
    const auto read = from_json<ImportTask>(text, "/a", "x");
    CHECK(to_json(read, "/a") == text);
    CHECK(read.volume == import.volume);
    CHECK(read.crop->upper == import.crop->upper);
    CHECK(read.choice == import.choice);
    CHECK(read.version == import.version);
    CHECK(read.blur_voxels == import.blur_voxels);
    const auto refusal = [](const char* given) {
        return error_of([&] { static_cast<void>(from_json<ImportTask>(given, "/", "x")); });
    };
    CHECK(contains(refusal(R"({"volume": "a", "project": "b", "crop": {"lower": [1,1,1], "upper": [1,2,2]}})"),
                   "x: key crop is"));
    CHECK(contains(refusal(R"({"volume": "a"})"), "key project is missing"));
    CHECK(contains(refusal(R"({"volume": "a", "project": "b", "downscale": 65})"), "key downscale is 65"));
    CHECK(contains(refusal(R"({"volume": "a", "project": "b", "cropp": 1})"), "unknown key cropp"));

    LabelTask label{.threshold = 12.5, .connectivity = Connectivity::corners, .fewest_voxels = 50, .largest = 7};
    CHECK(to_json(from_json<LabelTask>(to_json(label, "/"), "/", "x"), "/") == to_json(label, "/"));
    CHECK(contains(error_of([] { static_cast<void>(from_json<LabelTask>(R"({"connectivity": 7})", "/", "x")); }),
                   "key connectivity is 7; expected 6 or 26"));
    EvaluateTask evaluate{.truth_mask = "/a.mask", .mask = "/b.mask", .truth_groups = {"255=1"}, .slack = 2.5};
    const auto again = from_json<EvaluateTask>(to_json(evaluate, "/"), "/", "x");
    CHECK(again.truth_groups == evaluate.truth_groups);
    CHECK(again.slack == evaluate.slack);
    CHECK(again.mask == evaluate.mask);
    CHECK(from_json<DescribeTask>(R"({"input": "a", "set": ["volume.unit=um"]})", "/", "x").settings ==
          std::vector<std::string>{"volume.unit=um"});
}

TEST_CASE("tasks refuse options that make no sense before they do anything")
{
    const TemporaryFolder folder;
    PlainReporter reporter;
    const std::filesystem::path project = folder.path / "p";
    const auto refusal = [&](const ImportTask& task) { return error_of([&] { run(task, reporter); }); };
    CHECK(refusal({.volume = "a", .project = project, .raw = "5x4x3:uint8", .choice = {.spacing = glm::dvec3(1.0)}}) ==
          "spacing is given without a unit; expected unit, too, as in unit um");
    CHECK(contains(refusal({.volume = "a", .project = project, .blur_voxels = glm::dvec3(-1.0)}), "blur is -1"));
    CHECK(contains(refusal({.volume = "a", .project = project, .downscale = 0}), "downscale is 0"));
    CHECK(contains(refusal({.volume = "a", .project = project, .raw = "x"}), "x"));
    CHECK(contains(refusal({.project = project}), "no volume is given"));
    CHECK(std::filesystem::is_empty(folder.path));
    CHECK_THROWS_AS(check(LabelTask{.threshold = std::nan("")}), UsageError);
    CHECK_THROWS_AS(check(LabelTask{.output = "a.jpg"}), UsageError);
    CHECK_THROWS_AS(check(EvaluateTask{.truth_mask = "a.mask"}), UsageError);
    CHECK_THROWS_AS(check(EvaluateTask{.truth_mask = "a.mask", .mask = "b.mask", .truth_groups = {"0=1"}}), UsageError);
}

TEST_CASE("a volume is imported, described and labelled")
{
    const TemporaryFolder folder;
    Listener listener;
    const std::filesystem::path project = folder.path / "p";
    const ImportResult imported = run(ImportTask{.volume = CHIRALITY_NRRD, .project = project}, listener);
    CHECK(imported.report.info.size == Size3(5, 4, 3));
    CHECK(is_chirality_phantom(*open_volume(project)));
    CHECK(listener.stretches == std::vector<std::string>{"importing " + CHIRALITY_NRRD.string()});

    const DescribeResult described = run(DescribeTask{.input = project, .exact = true}, listener);
    CHECK(described.statistics.minimum == -99);
    CHECK(described.statistics.maximum == 135);
    CHECK(described.mask.filename() == "paint");
    CHECK(listener.stretches.back() == "measuring " + project.string());

    const LabelTask label{.threshold = 100.0, .output = folder.path / "l.mask"};
    const LabelResult labelled = run(label, *open_volume(project), "p", listener);
    CHECK(labelled.counts.found == 1);
    CHECK(labelled.counts.foreground_voxels == 20);
    CHECK(labelled.type == VoxelType::uint8);
    CHECK(bytes_of_file(label.output) == std::string(40, '\0') + std::string(20, '\1'));
    CHECK(listener.stretches.back() == "writing " + label.output.string());

    const EvaluateTask evaluate{.truth_mask = label.output, .mask = label.output};
    const EvaluateResult evaluated = run(evaluate, listener);
    CHECK(evaluated.dice->painted == 1.0);
    CHECK(evaluated.dice->voxels_in_a.at(1) == 20);
    CHECK(!evaluated.nodes);
}

TEST_CASE("looking for the ends of what is to be reversed says how far it is, and can be stopped")
{
    const TemporaryFolder folder;
    constexpr int64_t SIDE = 384;  // more than one step
    const std::filesystem::path raw = folder.path / "a.raw";
    std::ofstream(raw).put('v');
    std::filesystem::resize_file(raw, uint64_t(SIDE * SIDE * SIDE));
    const ImportTask task{.volume = raw, .project = folder.path / "p", .reverse = true, .raw = "384x384x384:uint8"};
    Listener stopped(2);
    CHECK_THROWS_AS(run(task, stopped), Stopped);
    CHECK(stopped.stretches == std::vector<std::string>{"measuring " + raw.string()});
    REQUIRE(stopped.fractions.size() == 2);
    CHECK(stopped.fractions[0] == 0.0);
    CHECK(stopped.fractions[1] > 0.0);
    CHECK(stopped.fractions[1] < 1.0);
    CHECK(!std::filesystem::exists(folder.path / "p"));
    CHECK(!std::filesystem::exists(folder.path / "p.part"));
}

TEST_CASE("of a sparse volume to be reversed only what is stored is looked at")
{
    const TemporaryFolder folder;
    const SparseZarr image{.size = Size3(1 << 20), .chunk = Size3(32), .fill = 7};
    write_sparse(
        folder.path / "sparse", image,
        [](int) {
            return std::vector<Size3>{{5, 6, 7}};
        },
        [](int, const Size3&) { return uint8_t{200}; });
    const VoxelBox crop{{5 * 32 - 2, 6 * 32, 7 * 32}, {5 * 32 + 2, 6 * 32 + 1, 7 * 32 + 1}};
    Listener listener;
    run(ImportTask{.volume = folder.path / "sparse", .project = folder.path / "p", .crop = crop, .reverse = true},
        listener);
    CHECK(voxels_of<uint8_t>(*open_volume(folder.path / "p")) == std::vector<uint8_t>{200, 200, 7, 7});
    CHECK(listener.stretches.front() == "measuring " + (folder.path / "sparse").string());
}
