// Every shortcut that has a key in the thesis's set acts: something that a person can tell is another afterwards.

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include <doctest/doctest.h>

#include "engine/workbench/bindings/keymap.h"
#include "haptics/simulated_device.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// Room in both directions for all that keys move; two nodes near the probe, one of them selected; a stroke, and one
/// that was undone.
constexpr const char* BEFORE[] = {
    R"({"op":"set","values":{"cut":{"lower":[4,4,4],"upper":[28,28,28]},"blend":{"size":0.5,"rate":1}}})",
    R"({"op":"set","values":{"light":{"occlusion":{"strength":0.5,"automatic":false}},"probe":{"group":2}}})",
    R"({"op":"place_clips","near":10,"far":90})",
    R"({"op":"paint","brush":"fill","region":"ball","group":3,"threshold":100,"radius":6,"path":[[20,18,16]]})",
    R"({"op":"node","at":[10,12,14],"radius":2,"group":2})",
    R"({"op":"node","at":[20,12,14]})",
    R"({"op":"node","at":[20,16,14]})",
    R"({"op":"paint","brush":"fill","group":5,"threshold":90,"radius":4,"path":[[9,18,16]]})",
    R"({"op":"undo"})",
    R"({"op":"place_probe","voxel":[11,12,13]})",
};

/// Further actions that some shortcuts need beforehand.
const std::map<std::string, std::vector<const char*>> BESIDES{
    {"step_back", {R"({"op":"set","values":{"probe":{"tool":"paint"}}})"}},
    {"tool_turn", {R"({"op":"set","values":{"probe":{"tool":"paint"}}})"}},
    {"auto_contrast", {R"({"op":"set","values":{"view":{"slices":{"white":900}}}})"}},
    {"mend_cut", {R"({"op":"select","node":1})", R"({"op":"delete"})"}},
    {"group_2", {R"({"op":"set","values":{"probe":{"group":4}}})"}},
    {"single_view", {R"({"op":"set","values":{"view":{"arrangement":"slices"}}})"}},
    {"select_nearest", {R"({"op":"deselect"})"}},
    {"regroup_2", {R"({"op":"group","group":4})"}},
    {"stronger", {R"({"op":"set","values":{"probe":{"touch":{"strength":0.5}}}})"}},
};

/// Shortcuts that use the pointer (tested in hands_test.cpp) or what a stylus holds (hand_test.cpp).
const std::vector<std::string> LEFT_OUT{"large_screenshot", "pivot_at_pointer", "probe_onto",
                                        "grab_volume",      "end_measure",      "take_back_point"};

/// Shortcuts that change nothing in the recorded state: a message is their whole effect.
const std::vector<std::string> ONLY_SAY{"update_occlusion", "regroup_0", "quit"};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "every shortcut of the thesis's set acts")
{
    const Keymap thesis(KeySet::thesis);
    size_t tried = 0;
    for (const Shortcut& shortcut : shortcuts()) {
        const bool is_left_out = std::ranges::find(LEFT_OUT, shortcut.id) != LEFT_OUT.end();
        if (thesis.chords_of(shortcut).empty() || is_left_out) continue;
        CAPTURE(std::string(shortcut.id));
        TemporaryFolder folder;
        Workbench bench(renderer(), {.has_servo = false, .settings = folder.path});
        bench.set_pixels({48, 40});
        bench.open(write_tubes_session(folder.path), {});
        for (const char* line : BEFORE) bench.perform(read_action(line, "row"));
        if (const auto more = BESIDES.find(shortcut.id); more != BESIDES.end())
            for (const char* line : more->second) bench.perform(read_action(line, "row"));
        settle(bench);
        const State before = state_of(bench, folder.path);
        const size_t said = bench.messages().count();
        bench.apply(shortcut.action(bench.model(), 1.0));
        if (shortcut.mode == Shortcut::Mode::while_held) bench.apply(shortcut.action(bench.model(), 0.0));
        settle(bench);
        bench.wait_for_screenshots();
        const bool only_says = std::ranges::find(ONLY_SAY, shortcut.id) != ONLY_SAY.end();
        const std::string changed = difference(before, state_of(bench, folder.path));
        const bool acts = !changed.empty() || (only_says && (bench.messages().count() > said || bench.take_quit())) ||
                          !bench.take_focus().empty();
        CHECK(acts);
        ++tried;
    }
    CHECK(tried > 85);
}

TEST_CASE_FIXTURE(OnDevice, "a group that is no node's is refused in a sentence")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    for (const char* line : BEFORE) bench.perform(read_action(line, "row"));
    settle(bench);
    const Shortcut& shortcut = *shortcut_named("regroup_0");
    CHECK_FALSE(bench.apply(shortcut.action(bench.model(), 1.0)));
    CHECK(contains(bench.messages().last(), "Group 0 is the eraser, and traces belong to a group from 1 up"));
}

TEST_CASE_FIXTURE(OnDevice, "the workspace's scale is what a device's moves are multiplied by, within limits")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    const auto press = [&](const char* id, double amount) {
        bench.perform(shortcut_named(id)->action(bench.model(), amount));
        return bench.model().session.interaction.workspace_scale;
    };
    CHECK(press("larger_workspace", 1.0) == doctest::Approx(1.1));
    CHECK(press("smaller_workspace", 1.0) == doctest::Approx(1.0));
    CHECK(press("larger_workspace", 1000.0) == MAX_WORKSPACE_SCALE);
    CHECK(press("smaller_workspace", 1000.0) == MIN_WORKSPACE_SCALE);
}

TEST_CASE_FIXTURE(OnDevice, "a hand moves the probe by the workspace's scale as far")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = true});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    auto device = std::make_unique<SimulatedDevice>();
    device->wish().publish({.position_m = {0.01, 0.0, 0.0}, .buttons = 0, .jump = 1});
    bench.use_device(std::move(device), "a hand");
    const glm::dvec3 target = bench.model().camera.target;
    const auto reach = [&](double scale) {
        bench.perform(
            read_action(sentence(R"({"op":"set","values":{"interaction":{"workspace_scale":)", scale, "}}}"), "row"));
        double distance = 0.0, before = -1.0;
        // The servo is another thread: until it has taken the scale, and the probe rests.
        for (int turn = 0; turn < 2000 && (turn < 100 || distance != before); ++turn) {
            before = distance;
            bench.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            distance = glm::distance(bench.document().touch.probe(), target);
        }
        return distance;
    };
    const double once = reach(1.0);
    CHECK(once > 0.0);
    CHECK(reach(2.5) == doctest::Approx(2.5 * once).epsilon(1e-9));
    CHECK(reach(0.1) == doctest::Approx(0.1 * once).epsilon(1e-9));
}
