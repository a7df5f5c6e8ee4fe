// The taker of files alone: what a file is decides who is asked to take it.

#include <doctest/doctest.h>

#include "engine/workbench/services/file_taker.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct TakerAlone : DeskWithScan {
    std::vector<std::filesystem::path> opened, together;
    std::string patch;
    FileTaker taker{desk,
                    {.allow_outside = notes("allow_outside"),
                     .begin_open =
                         [this](const std::filesystem::path& path, const std::vector<std::string>&,
                                std::vector<std::filesystem::path> taken_into_it, bool) {
                             opened.push_back(path);
                             together = std::move(taken_into_it);
                         },
                     .take_session = notes("take_session"),
                     .set = [this](const Set& change) { patch = change.patch; },
                     .record_settings = notes("record_settings"),
                     .show_changes = notes("show_changes")}};
    /// Returns the failures of the jobs that `action` starts.
    std::string take(const auto& action)
    {
        std::string failures;
        taker.act(action);
        until(
            [&] {
                for (const Jobs::Finished& job : desk.jobs.finish()) failures += job.failure;
            },
            [&] { return desk.jobs.is_idle(); });
        return failures;
    }
};

}  // namespace

TEST_CASE_FIXTURE(TakerAlone,
                  "taker: a session is opened, a transfer function is set, and neither is taken as the other")
{
    const std::filesystem::path other = folder.path / "other.json";
    write_session(other);
    CHECK(take(TakeFile{.path = other}).empty());
    CHECK(opened == std::vector{other});
    CHECK(take_calls().empty());
    const auto look = folder.write("look.json", R"({"points":[{"intensity":0,"color":[1,1,1],"opacity":0.5}]})");
    CHECK(take(TakeFile{.path = look}).empty());
    CHECK(opened.size() == 1);
    CHECK(contains(patch, "transfer_function"));
    CHECK(take_calls() == "record_settings");
}

TEST_CASE_FIXTURE(TakerAlone, "taker: a file of no known kind is refused with its name")
{
    const auto file = folder.write("notes.txt", "watered on Monday");
    CHECK(contains(take(TakeFile{.path = file}), "notes.txt"));
    CHECK(opened.empty());
    CHECK(take_calls().empty());
}

TEST_CASE_FIXTURE(TakerAlone, "taker: annotation needs a scan; a scan that is meant is opened with what comes with it")
{
    taker.act(TakeFile{.path = "a.raw", .beside = "b.mask\n", .use = FileUse::scan});
    CHECK(opened == std::vector<std::filesystem::path>{"a.raw"});
    CHECK(together == std::vector<std::filesystem::path>{"b.mask"});
    taker.act(Open{.path = "c.json", .saves_outside = true});
    CHECK(take_calls() == "allow_outside");
    CHECK(opened.back() == "c.json");
    desk.document.reset();
    CHECK(contains(error_of([&] { taker.act(TakeFile{.path = "b.mask", .use = FileUse::mask}); }),
                   "belongs to a volume"));
}

TEST_CASE_FIXTURE(TakerAlone, "taker: what the header of a mask states is kept by the next save and by exports")
{
    std::string voxels(40 * 36 * 32, '\0');
    voxels[7] = 2;
    const auto file = folder.write("s.seg.nrrd",
                                   "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 36 32\nspacings: 1 1 1\nencoding: "
                                   "raw\nSegment0_LabelValue:=2\nSegment0_Tags:=Anatomy^SCT^1\n\n" +
                                       voxels);
    CHECK(take(TakeFile{.path = file, .use = FileUse::mask}).empty());
    CHECK(document().annotator.document().mask.voxels_by_group()[2] == 1);
    CHECK(document().annotator.work().mask_of_header() == file);
}
