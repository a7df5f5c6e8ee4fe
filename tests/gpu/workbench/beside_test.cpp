// Saving and opening in the background: no iteration of the loop waits for a disk, whatever the disk does.

#include <cerrno>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/formats/open_volume.h"
#include "tests/gpu/workbench/slow_disk.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// The voxels of a label image, as a `.mask` holds them.
std::string groups_in(const std::string& labels)
{
    const std::unique_ptr<VolumeSource> source = open_volume(labels);
    const Size3 size = source->info().size;
    std::string groups(size_t(size.x * size.y * size.z), '?');
    source->read({Size3(0), size}, std::as_writable_bytes(std::span(groups)));
    return groups;
}

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
    bool mask_holds(uint8_t group) const
    {
        return read_text(path("scan.mask"), int64_t{1} << 20).find(char(group)) != std::string::npos;
    }
    bool said(const std::string& text) const
    {
        for (const Message& message : bench.messages().all())
            if (message.text.find(text) != std::string::npos) return true;
        return false;
    }
    /// Turns until it holds.
    template <class Condition>
    void turn_until(const Condition& condition)
    {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (!condition()) {
            REQUIRE(std::chrono::steady_clock::now() < end);
            bench.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    void tiny_volume(const char* name, int side) const
    {
        std::string text =
            sentence("NRRD0004\ntype: uint8\ndimension: 3\nsizes: ", side, " ", side, " ", side, "\nencoding: raw\n\n");
        for (int voxel = 0; voxel < side * side * side; ++voxel) text += char(voxel * 7 % 251);
        folder.write(name, text);
    }
};

size_t steps_of(const std::string& journal)
{
    size_t steps = 0;
    for (const JournalRecord& record : scan_journal(journal).records) steps += record.kind == RecordKind::command;
    return steps;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "while a save waits for the disk everything goes on, and what is painted stays unsaved")
{
    Desk desk(renderer());
    desk.stroke(3);
    SlowDisk disk;
    disk.stop_at("scan.mask");
    desk.bench.perform(SaveOp{});
    desk.turn_until([&] { return disk.is_waited_for(); });
    CHECK(desk.bench.model().is_saving);
    CHECK(desk.bench.model().jobs.size() == 1);
    // The user goes on.
    desk.stroke(5);
    desk.bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    desk.bench.perform(UndoOp{1});
    for (int turn = 0; turn < 200; ++turn) desk.bench.advance();
    CHECK(desk.bench.model().voxels_by_group[5] > 0);
    CHECK(disk.is_waited_for());
    CHECK(disk.calls_of_this_thread() == 0);
    disk.go_on();
    settle(desk.bench);
    CHECK(disk.calls_of_this_thread() == 0);
    CHECK(disk.calls_of_others() > 0);
    CHECK(desk.said("what was done since the save began is not in it"));
    CHECK(desk.mask_holds(3));
    CHECK_FALSE(desk.mask_holds(5));
    CHECK_FALSE(desk.bench.model().is_saved);
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    CHECK(desk.mask_holds(5));
    CHECK(desk.bench.model().is_saved);
    CHECK(disk.calls_of_this_thread() == 0);
}

TEST_CASE_FIXTURE(OnDevice, "a save during a save follows it, once, and holds what was done in between")
{
    Desk desk(renderer());
    desk.stroke(3);
    SlowDisk disk;
    disk.stop_at("scan.mask");
    desk.bench.perform(SaveOp{});
    desk.turn_until([&] { return disk.is_waited_for(); });
    desk.stroke(5);
    for (int presses = 0; presses < 3; ++presses) desk.bench.perform(SaveOp{});
    CHECK(desk.bench.why_not(SaveAs{desk.path("other.json")}) == "the work is being saved");
    disk.go_on();
    settle(desk.bench);
    CHECK(desk.mask_holds(5));
    CHECK(desk.bench.model().is_saved);
    int saves = 0;
    for (const JournalRecord& record : scan_journal(desk.path("scan.journal")).records)
        saves += record.kind == RecordKind::saving;
    CHECK(saves == 2);
}

TEST_CASE_FIXTURE(OnDevice, "a save that fails half way says so, marks nothing as saved, and the next one succeeds")
{
    Desk desk(renderer());
    desk.bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    const std::string before = read_text(desk.path("scan.json"), int64_t{1} << 20);
    desk.stroke(3);
    desk.bench.perform(Set{R"({"light":{"ambient":0.31}})"});
    desk.bench.perform(MoveOp{{11, 12, 14}});
    SlowDisk disk;
    disk.refuse_at("scan.graphml", ENOSPC);
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    CHECK(desk.said("No space left on device"));
    CHECK_FALSE(desk.bench.model().is_saved);
    CHECK(read_text(desk.path("scan.json"), int64_t{1} << 20) == before);
    CHECK(scan_journal(desk.path("scan.journal")).records.back().kind != RecordKind::saved);
    disk.go_on();
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    CHECK(desk.bench.model().is_saved);
    CHECK_FALSE(std::filesystem::exists(desk.path("scan.mask.old")));
    CHECK_FALSE(std::filesystem::exists(desk.path("scan.graphml.old")));
}

TEST_CASE_FIXTURE(OnDevice, "leaving waits for the save, and for another one where work went on")
{
    Desk desk(renderer());
    desk.stroke(3);
    SlowDisk disk;
    disk.stop_at("scan.mask");
    std::string why;
    CHECK(desk.bench.leave(why) == Workbench::Leave::later);
    desk.turn_until([&] { return disk.is_waited_for(); });
    CHECK(desk.bench.leave(why) == Workbench::Leave::later);
    desk.stroke(5);
    disk.go_on();
    desk.turn_until([&] { return desk.bench.leave(why) == Workbench::Leave::now; });
    CHECK(desk.mask_holds(5));
    // One that cannot be saved is refused, once, with the reason.
    desk.stroke(6);
    disk.refuse_at("scan.mask", ENOSPC);
    Workbench::Leave answer = Workbench::Leave::later;
    desk.turn_until([&] { return (answer = desk.bench.leave(why)) != Workbench::Leave::later; });
    CHECK(answer == Workbench::Leave::refused);
    CHECK(why.find("No space left on device") != std::string::npos);
    CHECK(disk.calls_of_this_thread() == 0);
}

TEST_CASE_FIXTURE(OnDevice, "leaving waits for what is being exported, or for its being cancelled")
{
    Desk desk(renderer());
    desk.stroke(3);
    desk.turn_until([&] { return desk.bench.model().jobs.empty() && !desk.bench.model().is_painting; });
    std::string why;
    for (const bool is_cancelled : {false, true}) {
        CAPTURE(is_cancelled);
        SlowDisk disk;
        disk.stop_at("exported.mask");
        desk.bench.perform(ExportTask{.mask = desk.path("exported.mask")});
        desk.turn_until([&] { return disk.is_waited_for(); });
        CHECK(desk.bench.leave(why) == Workbench::Leave::later);
        CHECK(desk.said("Waiting until the current file is written"));
        if (is_cancelled) desk.bench.perform(CancelJob{desk.bench.model().jobs.at(0).number});
        disk.go_on();
        desk.turn_until([&] { return desk.bench.leave(why) == Workbench::Leave::now; });
        CHECK((is_cancelled || std::filesystem::exists(desk.path("exported.mask"))));
        CHECK(desk.said(is_cancelled ? "Cancelled: exporting" : "Exported "));
    }
}

TEST_CASE_FIXTURE(OnDevice, "a save that is cancelled leaves the work unsaved, and nothing is lost")
{
    Desk desk(renderer());
    desk.stroke(3);
    SlowDisk disk;
    disk.stop_at("scan.mask");
    desk.bench.perform(SaveOp{});
    desk.turn_until([&] { return disk.is_waited_for(); });
    desk.bench.perform(CancelJob{desk.bench.model().jobs.front().number});
    disk.go_on();
    settle(desk.bench);
    CHECK(desk.said("Cancelled: saving"));
    CHECK_FALSE(desk.bench.model().is_saved);
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    CHECK(desk.bench.model().is_saved);
}

TEST_CASE_FIXTURE(OnDevice, "while Save as waits for the disk all but commands goes on, and settings follow it")
{
    Desk desk(renderer());
    desk.stroke(3);
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    const auto bytes_of = [&](const char* name) { return read_text(desk.path(name), int64_t{1} << 24); };
    const std::string mask = bytes_of("scan.mask"), session = bytes_of("scan.json");
    SlowDisk disk;
    disk.stop_at("other.labels.zarr");
    desk.bench.perform(SaveAs{desk.path("other.json")});
    desk.turn_until([&] { return disk.is_waited_for(); });
    const char* const WHY = "the work is being saved under another name";
    CHECK(desk.bench.why_not(Paint{true}) == WHY);
    CHECK(desk.bench.why_not(UndoOp{1}) == WHY);
    CHECK_THROWS_AS(desk.stroke(5), Error);
    CHECK_THROWS_AS(desk.bench.perform(UndoOp{1}), Error);
    CHECK(desk.bench.model().voxels_by_group[3] > 0);
    desk.bench.perform(Orbit{0.1, 0.2});
    desk.bench.perform(Set{R"({"light":{"ambient":0.31}})"});
    for (int turn = 0; turn < 200; ++turn) desk.bench.advance();
    CHECK(desk.bench.model().session_path == desk.path("scan.json"));
    CHECK(disk.calls_of_this_thread() == 0);
    disk.go_on();
    settle(desk.bench);
    CHECK(disk.calls_of_this_thread() == 0);
    CHECK(desk.said("Saved as " + desk.path("other.json")));
    CHECK(desk.bench.model().session_path == desk.path("other.json"));
    CHECK_FALSE(desk.bench.model().is_saved);  // the light is a step after the save
    CHECK(desk.bench.model().undoable == 2);
    desk.bench.perform(UndoOp{1});
    CHECK(desk.bench.model().session.light.ambient != 0.31);
    CHECK(steps_of(desk.path("scan.journal")) == 1);
    CHECK(steps_of(desk.path("other.journal")) == 2);
    CHECK(bytes_of("scan.mask") == mask);
    CHECK(bytes_of("scan.json") == session);
    CHECK(groups_in(desk.path("other.labels.zarr")) == mask);
}

TEST_CASE_FIXTURE(OnDevice,
                  "a Save as that fails or is cancelled leaves nothing, and the work goes on as it was called")
{
    Desk desk(renderer());
    desk.stroke(3);
    for (const bool is_cancelled : {false, true}) {
        CAPTURE(is_cancelled);
        SlowDisk disk;
        if (is_cancelled)
            disk.stop_at("other.labels.zarr");
        else
            disk.refuse_at("other.labels.zarr", ENOSPC);
        desk.bench.perform(SaveAs{desk.path("other.json")});
        if (is_cancelled) {
            desk.turn_until([&] { return disk.is_waited_for(); });
            desk.bench.perform(CancelJob{desk.bench.model().jobs.front().number});
            disk.go_on();
        }
        settle(desk.bench);
        CHECK(desk.said(is_cancelled ? "Cancelled: saving" : "No space left on device"));
        CHECK(desk.bench.model().session_path == desk.path("scan.json"));
        for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(desk.folder.path))
            CHECK_FALSE(entry.path().filename().string().starts_with("other"));
        desk.stroke(is_cancelled ? 5 : 4);
        CHECK(desk.bench.model().voxels_by_group[is_cancelled ? 5 : 4] > 0);
    }
    desk.bench.perform(SaveAs{desk.path("other.json")});
    settle(desk.bench);
    CHECK(desk.bench.model().is_saved);
    CHECK(steps_of(desk.path("other.journal")) == 3);
}

TEST_CASE_FIXTURE(OnDevice, "a copy is of what was there when it was asked for, and waits for no disk here")
{
    Desk desk(renderer());
    desk.stroke(3);
    SlowDisk disk;
    disk.stop_at("copy.labels.zarr");
    desk.bench.perform(CopySession{desk.path("copy.json")});
    desk.turn_until([&] { return disk.is_waited_for(); });
    CHECK(desk.bench.shows_jobs());
    desk.stroke(5);
    disk.go_on();
    settle(desk.bench);
    CHECK(disk.calls_of_this_thread() == 0);
    CHECK(desk.said("Copied to " + desk.path("copy.json")));
    CHECK_FALSE(desk.bench.shows_jobs());
    const std::string mask = groups_in(desk.path("copy.labels.zarr"));
    CHECK(mask.find(char(3)) != std::string::npos);
    CHECK(mask.find(char(5)) == std::string::npos);
    CHECK(desk.bench.model().session_path == desk.path("scan.json"));
}

TEST_CASE_FIXTURE(OnDevice, "what is open can be used until the next stands, which goes onto the device in slices")
{
    Desk desk(renderer());
    desk.tiny_volume("next.nrrd", 160);  // 125 bricks: two uploads
    SlowDisk disk;
    desk.bench.perform(Open{desk.path("next.nrrd")});
    bool was_loading = false, was_painted = false;
    desk.turn_until([&] {
        for (const Jobs::State& job : desk.bench.model().jobs)
            was_loading = was_loading || job.stretch == "loading next.nrrd onto the device";
        if (was_loading && !was_painted && desk.bench.model().volume.size != Size3(160)) {
            desk.stroke(3);
            was_painted = true;
        }
        return desk.bench.model().volume.size == Size3(160);
    });
    CHECK(was_loading);
    CHECK(was_painted);
    CHECK(disk.calls_of_this_thread() == 0);
    settle(desk.bench);
    // Paint of the last moment is in the journal.
    CHECK(steps_of(desk.path("scan.journal")) == 1);
}

TEST_CASE_FIXTURE(OnDevice, "opening is cancelled at each stage, and what is open stays as it is")
{
    Desk desk(renderer());
    desk.stroke(3);
    desk.bench.perform(SaveOp{});
    settle(desk.bench);
    desk.tiny_volume("next.nrrd", 160);
    for (const bool is_loading : {false, true}) {
        CAPTURE(is_loading);
        const State before = state_of(desk.bench, desk.folder.path);
        desk.bench.perform(Open{desk.path("next.nrrd")});
        if (is_loading)
            desk.turn_until([&] {
                const std::vector<Jobs::State> jobs = desk.bench.model().jobs;
                return !jobs.empty() && jobs.front().stretch == "loading next.nrrd onto the device";
            });
        desk.bench.perform(CancelJob{desk.bench.model().jobs.front().number});
        settle(desk.bench);
        CHECK(desk.said("Cancelled: opening next.nrrd"));
        CHECK(desk.bench.model().opening.empty());
        CHECK(difference(before, state_of(desk.bench, desk.folder.path)).empty());
    }
}

TEST_CASE("where the device has no room for both, what is open is put away, and comes back where the next fails")
{
    TemporaryFolder folder;
    // 128^3 bytes take about 3 MiB, and pictures 4; the budget has room for one such volume.
    for (const char* name : {"a.json", "b.json"})
        folder.write(name, sentence(R"({"shvr_session": 1, "volume": {"procedural": "tubes", "size": [128, 128, 128],
            "seed": )",
                                    name[0] == 'a' ? 1 : 2, R"(}, "render": {"paging": "never"}})"));
    Renderer renderer({.device = {}, .budget = {.device_bytes = uint64_t{9} << 20, .host_bytes = 0}});
    Workbench bench(renderer, {.has_servo = false});
    bench.set_pixels({48, 40});
    bench.open(folder.path / "a.json", {});
    settle(bench);
    bench.perform(Open{folder.path / "b.json"});
    bool was_away = false;
    for (int turn = 0; bench.has_work() || turn < 3; ++turn) {
        nap(turn);
        bench.advance();
        was_away = was_away || !bench.is_open();
    }
    CHECK(was_away);
    CHECK(bench.model().session_path == folder.path / "b.json");
    settle(bench);
    // Cancelled while it is put away, it comes back.
    bench.perform(Open{folder.path / "a.json"});
    for (int turn = 0; turn < 60'000 && bench.is_open(); ++turn) {
        bench.advance();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    REQUIRE(!bench.model().jobs.empty());
    bench.perform(CancelJob{bench.model().jobs.front().number});
    settle(bench);
    REQUIRE(bench.is_open());
    CHECK(bench.model().session_path == folder.path / "b.json");
}
