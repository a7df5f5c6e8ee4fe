// Settings of the workbench: the message about a change, and whether the change redraws the picture.

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/workbench/edits/edit.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct Settings : OnDevice {
    TemporaryFolder folder;
    Workbench bench{renderer(), {.has_servo = false}};

    Settings()
    {
        bench.set_pixels({48, 40});
        bench.open(write_tubes_session(folder.path), {});
        settle(bench);
    }
    /// Returns how many submissions draw it.
    uint64_t perform(const Action& action)
    {
        const uint64_t before = bench.document().screen.submissions();
        bench.perform(action);
        settle(bench);
        return bench.document().screen.submissions() - before;
    }
    uint64_t set(const char* patch) { return perform(Set{patch}); }
};

}  // namespace

TEST_CASE_FIXTURE(Settings, "a changed curve of ambient occlusion is said in words, and draws nothing while it is off")
{
    const auto said = [&] { return bench.messages().last(); };

    set(R"({"light":{"occlusion":{"strength":0}}})");
    CHECK(set(R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":1,"seen":1}]}}})") == 0);
    CHECK(said() == "Occlusion curve: points from now on, 2 of them; occlusion is off, its strength is 0");
    CHECK(set(R"({"light":{"occlusion":{"radius":5}}})") == 0);

    CHECK(perform(UndoOp{1}) == 0);  // the radius
    CHECK(perform(UndoOp{1}) == 0);  // the curve
    CHECK(bench.model().session.light.occlusion.mapping.empty());
    CHECK(perform(RedoOp{2}) == 0);
    CHECK(bench.model().session.light.occlusion.radius == 5.0);

    CHECK(set(R"({"light":{"occlusion":{"strength":0.5}}})") > 0);
    CHECK(set(R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":1,"seen":0.5}]}}})") > 0);
    CHECK(said() == "Occlusion curve, point 2: where 100 % of the light arrives, 50 % is seen");
    CHECK(set(R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":0.5,"seen":0.2},)"
              R"({"arrives":1,"seen":0.5}]}}})") > 0);
    CHECK(said() == "Occlusion curve: a point added, 3 of them");
    CHECK(set(R"({"light":{"occlusion":{"mapping":null}}})") > 0);
    CHECK(said() == "Occlusion curve: a power again");
    CHECK(perform(UndoOp{1}) > 0);
}

TEST_CASE_FIXTURE(Settings,
                  "a transfer function that a preset gives is said by the preset's name, however it was chosen")
{
    const char* const two =
        R"({"transfer_function":{"points":[{"intensity":90,"opacity":0},{"intensity":200,"opacity":1}]}})";
    set(two);
    CHECK(bench.messages().last() == "Transfer function of 2 points, from 90 to 200");
    perform(edited(bench.model().session, [&](Session& session) {
        session.transfer_function = transfer_function_of(transfer_preset_named("viridis"), bench.model().statistics);
    }));
    CHECK(bench.messages().last() == "Transfer function: viridis");
    set(two);
    set(R"({"transfer_function":{"points":null,"preset":"fire"}})");
    CHECK(bench.messages().last() == "Transfer function: fire");
    perform(edited(bench.model().session, [&](Session& session) {
        session.transfer_function = automatic_transfer_function(bench.model().statistics);
    }));
    CHECK(bench.messages().last() == "Transfer function: from the histogram");
}

TEST_CASE_FIXTURE(OnDevice,
                  "a look that was applied is undone by its name, and leaves earlier changes a step of their own")
{
    const TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false, .settings = folder.path});
    bench.open(write_tubes_session(folder.path), {});
    settle(bench);
    bench.perform(KeepLook{.name = "mine", .path = {}});
    bench.perform(Set{R"({"light":{"ambient":0.5}})"});
    settle(bench);
    bench.perform(Set{R"({"groups":{"3":{"visible":false}}})"});
    bench.perform(TakeLook{"mine"});
    CHECK(bench.messages().last() == "Applied the look mine; undo takes it back");
    CHECK(bench.model().session.light.ambient == 0.3);
    bench.perform(UndoOp{1});
    CHECK(bench.messages().last() == "Undone: applied the look mine");
    CHECK(bench.model().session.light.ambient == 0.5);
    bench.perform(UndoOp{1});
    CHECK(bench.messages().last() == "Undone: hid group 3");
}

TEST_CASE_FIXTURE(Settings, "how the picture looks is a step of the history, how it is made is none")
{
    const RenderSettings before = bench.model().session.render;
    set(R"({"render":{"step_voxels":0.375}})");
    CHECK(bench.model().undoable == 0);
    CHECK(set(R"({"render":{"background":"#000000"}})") > 0);
    set(R"({"render":{"saturation":0.5}})");
    set(R"({"render":{"smooth_borders":true}})");
    CHECK(bench.model().undoable == 3);
    perform(UndoOp{2});
    CHECK(bench.model().session.render.background == glm::dvec4(0.0, 0.0, 0.0, 1.0));
    CHECK(perform(UndoOp{1}) > 0);
    RenderSettings expected = before;
    expected.step_voxels = 0.375;
    CHECK(bench.model().session.render == expected);
    CHECK(bench.messages().last() == "Undone: set background from #ffffff to #000000");
}

TEST_CASE_FIXTURE(Settings, "a recorded change of an option that was removed draws nothing, and warns")
{
    CHECK(set(R"({"render":{"adaptive_tolerance":0.05}})") == 0);
    const Message& said = bench.messages().all().back();
    CHECK(said.weight == Weight::warning);
    CHECK(said.text.starts_with("settings: render.adaptive_tolerance is ignored, as the option was removed"));
}

TEST_CASE_FIXTURE(Settings, "a session with an option that was removed opens in the window with a warning")
{
    const std::filesystem::path old =
        folder.write("old.json", R"({"shvr_session": 1, "volume": {"procedural": "tubes", "size": [16, 16, 16]},
                                     "render": {"adaptive_tolerance": 0.05}})");
    bench.open(old, {});
    settle(bench);
    const auto& all = bench.messages().all();
    const auto said = std::ranges::find_if(all, [](const Message& message) {
        return message.text.find("render.adaptive_tolerance is ignored") != std::string::npos;
    });
    REQUIRE(said != all.end());
    CHECK(said->text.starts_with("Opened "));
    CHECK(said->weight == Weight::warning);
}

TEST_CASE_FIXTURE(OnDevice, "a transfer function that a person keeps can be set by its name")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false, .settings = folder.path});
    bench.set_pixels({48, 40});
    bench.open(write_tubes_session(folder.path), {});
    settle(bench);
    const TransferFunction before = bench.model().session.transfer_function;
    bench.perform(KeepPreset{"mine"});
    bench.perform(Set{
        R"({"transfer_function":{"points":[{"intensity":70,"opacity":0},{"intensity":90,"opacity":0.1},{"intensity":210,"opacity":0.8}]}})"});
    bench.perform(Set{R"({"transfer_function":{"points":null,"preset":"mine"}})"});
    settle(bench);
    const TransferFunction& after = bench.model().session.transfer_function;
    REQUIRE(after.points().size() == before.points().size());
    CHECK(after.lower() == doctest::Approx(before.lower()));
    CHECK(after.upper() == doctest::Approx(before.upper()));
    CHECK_THROWS_WITH(bench.perform(Set{R"({"transfer_function":{"points":null,"preset":"no such"}})"}),
                      doctest::Contains("preset is \"no such\"; expected one of: "));
}
