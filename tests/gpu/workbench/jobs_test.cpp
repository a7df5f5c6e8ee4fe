// Background jobs: the open volume stays, painting goes on, and a job that fails reports it and changes nothing.

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct Desk {
    TemporaryFolder folder;
    Workbench bench;

    explicit Desk(Renderer& renderer) : bench(renderer, {.has_servo = false})
    {
        bench.set_pixels({48, 40});
        bench.open(write_tubes_session(folder.path), {});
        settle(bench);
    }
    void stroke(uint8_t group)
    {
        bench.perform(PaintOp{
            .brush = Brush::fill, .group = group, .threshold = 100, .radius_voxels = 6, .path = {{20, 18, 16}}});
    }
    std::string path(const char* name) const { return (folder.path / name).string(); }
    bool said(const std::string& text) const
    {
        for (const Message& message : bench.messages().all())
            if (message.text.find(text) != std::string::npos) return true;
        return false;
    }
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "an export holds what was there when it was asked for, whatever is painted meanwhile")
{
    Desk desk(renderer());
    desk.stroke(3);
    CHECK(desk.bench.why_not(ExportTask{}) == "no file is named; expected at least one to be written");
    CHECK(desk.bench.why_not(ExportTask{.mask = desk.path("before.mask")}).empty());
    desk.bench.perform(ExportTask{.mask = desk.path("before.mask")});
    desk.stroke(5);
    desk.bench.perform(ExportTask{.mask = desk.path("after.mask")});
    settle(desk.bench);
    const std::string before = read_text(desk.path("before.mask"), int64_t{1} << 20);
    const std::string after = read_text(desk.path("after.mask"), int64_t{1} << 20);
    CHECK(before.find(char(3)) != std::string::npos);
    CHECK(before.find(char(5)) == std::string::npos);
    CHECK(after.find(char(5)) != std::string::npos);
}

TEST_CASE_FIXTURE(OnDevice, "what there is nothing of yet is not exported, and the reason is one of the work")
{
    Desk desk(renderer());
    const std::string reason = "nothing is traced yet, so there is neither a trace nor a mesh to write";
    CHECK(desk.bench.why_not(ExportTask{.trace = desk.path("t.swc")}) == reason);
    CHECK(desk.bench.why_not(ExportTask{.mesh = desk.path("t.ply")}) == reason);
    CHECK(desk.bench.why_not(ExportTask{.labels = true}) ==
          "labels are written into a project, and this scan is none: import it as one, or name a mask");
    desk.bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    CHECK(desk.bench.why_not(ExportTask{.trace = desk.path("t.swc")}) == "");
    desk.bench.perform(ExportTask{.trace = desk.path("t.swc")});
    settle(desk.bench);
    CHECK(std::filesystem::exists(desk.path("t.swc")));
}

TEST_CASE_FIXTURE(OnDevice, "a job that is cancelled says so and leaves nothing")
{
    Desk desk(renderer());
    desk.bench.perform(LabelTask{.threshold = 50, .output = desk.path("first.nrrd")});
    desk.bench.perform(LabelTask{.threshold = 50, .output = desk.path("second.nrrd")});
    const std::vector<Jobs::State> jobs = desk.bench.model().jobs;
    REQUIRE(!jobs.empty());
    const uint64_t last = jobs.back().number;
    CHECK(desk.bench.why_not(CancelJob{last}).empty());
    CHECK(desk.bench.why_not(CancelJob{last + 7}) == sentence("there is no job ", last + 7));
    desk.bench.perform(CancelJob{last});
    settle(desk.bench);
    CHECK(desk.said("Cancelled: labelling"));
    CHECK_FALSE(std::filesystem::exists(desk.path("second.nrrd")));
    CHECK(desk.bench.model().jobs.empty());
}

TEST_CASE_FIXTURE(OnDevice, "what cannot be opened is said, and what is open stays as it is")
{
    Desk desk(renderer());
    desk.stroke(3);
    settle(desk.bench);
    const State before = state_of(desk.bench, desk.folder.path);
    desk.folder.write("broken.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8\n\n");
    for (const char* name : {"nothing.nrrd", "broken.nrrd"}) {
        desk.bench.perform(Open{desk.path(name)});
        settle(desk.bench);
        CHECK(desk.said(name));
        CHECK(desk.bench.messages().all().back().weight == Weight::error);
        State after = state_of(desk.bench, desk.folder.path);
        after.erase("file broken.nrrd");
        CHECK(difference(before, after).empty());
    }
    desk.stroke(5);
    CHECK(desk.bench.model().voxels_by_group[5] > 0);
}

TEST_CASE_FIXTURE(OnDevice, "what was painted while the next scan was being measured is saved before that is shown")
{
    Desk desk(renderer());
    std::string tiny = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n";
    for (int voxel = 0; voxel < 512; ++voxel) tiny += char(voxel % 251);
    desk.folder.write("tiny.nrrd", tiny);
    desk.bench.perform(Open{desk.path("tiny.nrrd")});
    desk.stroke(3);
    settle(desk.bench);
    CHECK(desk.bench.model().volume.size == Size3(8));
    CHECK(read_text(desk.path("scan.mask"), int64_t{1} << 20).find(char(3)) != std::string::npos);
}
