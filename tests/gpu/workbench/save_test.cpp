// A save includes the stroke under way, waits for its bricks, and not for ever.

#include <chrono>
#include <fstream>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "haptics/simulated_device.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// A paged scan, whose bricks are requested when something needs them.
std::filesystem::path write_paged_session(const std::filesystem::path& folder)
{
    std::ofstream(folder / "scan.json") << R"({"shvr_session": 1,
        "volume": {"procedural": "tubes", "size": [200, 200, 200], "seed": 5}, "render": {"paging": "always"},
        "probe": {"brush": "fill", "radius_voxels": 20, "voxel": [100, 100, 100], "paint_threshold": 1},
        "annotation": {"mask": "scan.mask"}})";
    return folder / "scan.json";
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "a save in the middle of a stroke holds all that the stroke covers")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_paged_session(folder.path), {});
    bench.perform(Paint{true});
    bench.perform(PlaceProbe{{60, 100, 100}});
    bench.perform(SaveOp{});
    CHECK(bench.model().is_saving);
    settle(bench);
    CHECK_FALSE(bench.model().is_painting);
    CHECK(bench.model().voxels_by_group[1] > 33000);  // two balls of radius 20
    CHECK(read_text(folder.path / "scan.mask", int64_t{1} << 24).find(char(1)) != std::string::npos);
}

TEST_CASE_FIXTURE(OnDevice, "a save whose bricks do not arrive within 20 s is made without the rest of the stroke")
{
    TemporaryFolder folder;
    double now_s = 0.0;
    bool is_late = false;
    Workbench bench(renderer(), {.has_servo = false, .now_s = [&] { return now_s += is_late ? 30.0 : 0.0; }});
    bench.open(write_paged_session(folder.path), {});
    bench.perform(Paint{true});
    is_late = true;  // from one look at the clock to the next
    bench.perform(SaveOp{});
    settle(bench);
    CHECK(bench.messages().last().find(
              "the rest of the stroke was not painted: its bricks did not arrive within 20 s") != std::string::npos);
    CHECK_FALSE(bench.model().is_painting);
    CHECK(std::filesystem::exists(folder.path / "scan.mask"));
}

TEST_CASE("finishing strokes tells why one was cut, whatever is painted after it")
{
    TemporaryFolder folder;
    Renderer renderer({.device = {}, .budget = {.device_bytes = uint64_t{12} << 20, .host_bytes = 0}});
    Workbench bench(renderer, {.has_servo = false});
    bench.open(write_paged_session(folder.path), {});
    bench.perform(Set{R"({"probe":{"radius_voxels":50}})"});
    for (const glm::dvec3& voxel : {glm::dvec3(100.0), glm::dvec3(0.0)}) {  // no room to ask for all of the first
        bench.perform(PlaceProbe{voxel});
        bench.perform(Paint{true});
        bench.perform(Paint{false});
    }
    const std::string unpainted = bench.finish_stroke();
    CHECK(unpainted.find("device memory: a step of the work needs") != std::string::npos);
    CHECK(unpainted.find("; the rest of the stroke is not painted") != std::string::npos);
    CHECK(bench.document().annotator.strokes_done() == 1);
    CHECK(bench.messages().last().starts_with("Painted "));
    CHECK(bench.finish_stroke().empty());
}

TEST_CASE_FIXTURE(OnDevice, "a part of a turn that fails is said once, and everything else goes on")
{
    TemporaryFolder folder;
    double now_s = 0.0;
    Workbench bench(renderer(), {.has_servo = false, .now_s = [&] { return now_s += 0.01; }});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    settle(bench);
    // A brush that is too large for its preview fails in every iteration.
    bench.perform(Set{R"({"probe":{"preview":true,"radius_voxels":126}})"});
    for (int turn = 0; turn < 200; ++turn) bench.advance();
    int failures = 0;
    for (const Message& message : bench.messages().all()) failures += message.weight == Weight::error;
    CHECK(failures <= 1);
    bench.perform(Set{R"({"probe":{"preview":false,"radius_voxels":4}})"});
    bench.perform(Paint{true});
    bench.perform(Paint{false});
    settle(bench);
    CHECK(bench.model().undoable == 1);
}

TEST_CASE_FIXTURE(OnDevice, "a button of a device that cannot do what it is for says why, and the work goes on")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.open(write_tubes_session(folder.path), {});
    auto device = std::make_unique<SimulatedDevice>();
    Latest<HandWish>& hand = device->wish();
    bench.use_device(std::move(device), "a hand");
    // With the eraser no node can be added.
    bench.perform(Set{R"({"probe":{"tool":"trace","group":0}})"});
    const auto press = [&](uint32_t buttons) {
        hand.publish({.buttons = buttons});
        const uint64_t messages = bench.messages().count();
        for (int turn = 0; turn < 2000 && bench.messages().count() == messages; ++turn) {
            bench.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            if (buttons == 0 && turn > 100) return;
        }
    };
    press(PAINT_BUTTON);
    CHECK(bench.messages().last() == "Group 0 is the eraser; choose a group from 1 up for the node");
    CHECK(bench.messages().all().back().weight == Weight::done);  // it does not apply; nothing has failed
    press(0);
    bench.perform(Set{R"({"probe":{"group":4}})"});
    press(PAINT_BUTTON);
    CHECK(bench.model().trace.nodes().size() == 1);
    press(0);
    // A button means what a person binds to it, as a key does.
    constexpr uint32_t SECOND = 1u << 1;
    press(SECOND);
    CHECK(bench.model().trace.nodes().size() == 1);
    press(0);
    bench.perform(AwaitKey{"undo"});
    press(SECOND);  // it takes hold of the volume, so it is asked for again
    CHECK(bench.model().key_question.find("'Move the volume with the stylus while held'") != std::string::npos);
    press(0);
    press(SECOND);
    CHECK(bench.model().trace.nodes().size() == 1);
    CHECK(bench.model().keymap.text_of(*shortcut_named("undo")) == "stylus button 2");
    press(0);
    press(SECOND);
    CHECK(bench.model().trace.nodes().empty());
    press(SECOND);  // held on: once
    press(0);
}

TEST_CASE_FIXTURE(OnDevice, "quitting without saving leaves the files as they are, and undo brings the rest back")
{
    TemporaryFolder folder;
    const auto path = write_tubes_session(folder.path);
    std::string saved;
    {
        Workbench bench(renderer(), {.has_servo = false});
        bench.open(path, {});
        bench.perform(NodeOp{.at = {10, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
        bench.perform(SaveOp{});
        settle(bench);
        saved = read_text(path, int64_t{1} << 20);
        bench.perform(NodeOp{.at = {20, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
        bench.perform(Set{R"({"light":{"ambient":0.9},"view":{"arrangement":"slices"}})"});
        settle(bench);
        bench.perform(Quit{.saves = false});
        CHECK(bench.take_quit());
        std::string why;
        Workbench::Leave leave = Workbench::Leave::later;
        for (int turn = 0; turn < 60'000 && leave == Workbench::Leave::later; ++turn) {
            bench.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            leave = bench.leave(why);
        }
        CHECK(leave == Workbench::Leave::now);
        bench.flush();
    }
    CHECK(read_text(path, int64_t{1} << 20) == saved);
    Workbench again(renderer(), {.has_servo = false});
    again.open(path, {});
    CHECK(again.model().trace.nodes().size() == 1);
    CHECK(again.model().session.light.ambient != 0.9);
    again.perform(UndoOp{1});
    CHECK(again.model().trace.nodes().size() == 2);
    CHECK(again.model().session.light.ambient == 0.9);
    // Actions after a refused or cancelled exit are saved as usual.
    again.perform(Quit{.saves = false});
    again.perform(NodeOp{.at = {30, 12, 14}, .radius_voxels = 2.0, .group = uint8_t{2}});
    std::string why;
    CHECK(again.leave(why) == Workbench::Leave::later);
    CHECK(again.is_saving());
    settle(again);
}
