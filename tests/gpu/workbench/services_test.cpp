// Services together, without workbench or window: requests that one refuses because of another, and the order of steps.

#include <chrono>
#include <fstream>
#include <thread>

#include <doctest/doctest.h>

#include "engine/workbench/services/services.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// The services on a desk with an open scan.
struct AtDesk : OnDevice {
    TemporaryFolder folder;
    Desk desk{renderer(), {.has_servo = false}};
    Services services{desk};
    std::filesystem::path session = write_tubes_session(folder.path);

    AtDesk()
    {
        desk.model = [this] { return model(); };
        desk.apply = [](const Action&) { return false; };
        services.opener.open(session, {}, {.program = "a test"});
    }
    Model model() const
    {
        const Services& all = services;
        return {desk.document_model(),
                all.viewer.model(),
                all.reader.model(),
                all.prober.model(),
                all.hand.model(),
                all.painter.model(),
                all.groups.model(),
                all.tracer.model(),
                all.settings.model(),
                all.saver.model(),
                all.opener.model(),
                all.taker.model(),
                all.tasks.model(),
                all.keeper.model(),
                all.presets.model(),
                all.window.model(),
                {}};
    }
    ui::Document& document() { return *desk.document; }
    const TraceGraph& trace() { return document().annotator.document().trace; }
    size_t steps() const { return services.settings.model().undoable; }
    const std::string& said() const { return desk.messages.last(); }
    bool says(std::string_view part) const { return said().find(part) != std::string::npos; }
    void set(const char* patch) { services.settings.act(Set{patch}); }
    /// Runs only jobs and the opener until nothing is being opened.
    void await_opening()
    {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
        while (services.opener.is_opening() && std::chrono::steady_clock::now() < end) {
            services.tasks.advance();
            services.opener.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        REQUIRE_FALSE(services.opener.is_opening());
    }
    Leave leave()
    {
        std::string why;
        const Leave answer = services.saver.leave(why);
        CHECK((answer == Leave::refused) == !why.empty());
        return answer;
    }
};

/// Why an action is refused; empty: it is not.
std::string refusal(const auto& act)
{
    try {
        act();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

bool has(const std::string& text, std::string_view part)
{
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE_FIXTURE(AtDesk, "opening: a file that is missing, or given up, leaves the open document as it is")
{
    Opener& opener = services.opener;
    const ui::Document* const open = desk.document.get();
    opener.begin_open(folder.path / "missing.json", {});
    CHECK(opener.is_opening());
    CHECK(opener.opening_name() == "missing.json");
    await_opening();
    CHECK(desk.document.get() == open);
    CHECK(has(std::string(opener.model().open_failure), "missing.json"));
    CHECK(*opener.model().failed_path == folder.path / "missing.json");

    opener.begin_open(session, {});
    CHECK(opener.model().open_failure.empty());
    opener.cancel();
    CHECK_FALSE(opener.is_opening());
    CHECK(says("Cancelled: opening scan.json"));
    opener.cancel();  // there is nothing left to cancel
    while (!desk.jobs.is_idle()) services.tasks.advance();
    CHECK(desk.document.get() == open);
    CHECK(desk.openings == 1);
}

TEST_CASE_FIXTURE(AtDesk, "opening: the last of two requests wins")
{
    std::filesystem::create_directory(folder.path / "other");
    const std::filesystem::path other = write_tubes_session(folder.path / "other");
    services.opener.begin_open(folder.path / "missing.json", {});
    services.opener.begin_open(other, {});
    await_opening();
    CHECK(document().session_path == other);
    CHECK(services.opener.model().open_failure.empty());
    CHECK(desk.openings == 2);
}

TEST_CASE_FIXTURE(AtDesk, "saving: a save under way is followed by one more, and refuses another name")
{
    Saver& saver = services.saver;
    services.tracer.act(NodeOp{.at = {20, 18, 16}, .radius_voxels = {}, .group = {}});
    CHECK_FALSE(saver.model().is_saved);
    saver.act(SaveOp{});
    CHECK(saver.is_saving());
    CHECK(leave() == Leave::later);
    CHECK(has(refusal([&] { saver.act(SaveAs{folder.path / "new.json"}); }), "the work is being saved"));
    CHECK(has(refusal([&] { saver.act(CorrectSpacing{.spacing = glm::dvec3(2.0), .unit = {}}); }), "being saved"));
    saver.act(SaveOp{});
    CHECK(says("saved again after the running save"));
    saver.finish_save();
    CHECK_FALSE(saver.is_saving());
    CHECK(saver.model().is_saved);
    CHECK_FALSE(std::filesystem::exists(folder.path / "new.json"));
    saver.act(SaveAs{folder.path / "new.json"});
    saver.finish_save();
    CHECK(document().session_path == folder.path / "new.json");
}

TEST_CASE_FIXTURE(AtDesk, "saving: discarded work is left at once, and a request to quit is answered once")
{
    Saver& saver = services.saver;
    services.tracer.act(NodeOp{.at = {20, 18, 16}, .radius_voxels = {}, .group = {}});
    CHECK_FALSE(saver.take_quit());
    saver.act(Quit{.saves = false});
    CHECK(services.settings.is_discarded());
    CHECK(trace().nodes().empty());
    CHECK(leave() == Leave::now);
    CHECK_FALSE(saver.is_saving());
    CHECK(saver.take_quit());
    CHECK_FALSE(saver.take_quit());
}

TEST_CASE_FIXTURE(AtDesk, "painting: one stroke at a time, which the next change waits for")
{
    Painter& painter = services.painter;
    const Annotator& annotator = document().annotator;
    painter.act(Paint{false});
    CHECK_FALSE(annotator.stroke_is_running());
    painter.act(Paint{true});
    painter.act(Paint{true});  // a key that repeats
    CHECK(annotator.stroke_is_open());
    CHECK(has(refusal([&] { painter.act(document().stroke()); }), "a stroke is being painted"));
    CHECK(has(refusal([&] {
                  services.tracer.act(NodeOp{.at = {20, 18, 16}, .radius_voxels = {}, .group = {}});
              }),
              "while a stroke is being painted"));
    CHECK(has(refusal([&] { services.settings.act(UndoOp{}); }), "A stroke is being painted"));
    painter.act(Paint{false});
    CHECK_FALSE(annotator.stroke_is_open());
    CHECK(painter.finish_stroke().empty());
    CHECK(annotator.strokes_done() == 1);
    CHECK(steps() == 1);
    set(R"({"probe":{"tool":"trace"}})");
    painter.act(Paint{true});
    CHECK_FALSE(annotator.stroke_is_running());
    CHECK(trace().nodes().size() == 1);
}

TEST_CASE_FIXTURE(AtDesk, "painting: a change of settings comes before the stroke that follows it")
{
    set(R"({"probe":{"radius_voxels":3}, "light":{"ambient":0.125}})");
    CHECK(services.settings.has_settings_to_record());
    services.painter.act(Paint{true});
    CHECK_FALSE(services.settings.has_settings_to_record());
    CHECK(services.painter.finish_stroke().empty());
    services.settings.act(UndoOp{});
    CHECK(document().session.light.ambient == 0.125);
    services.settings.act(UndoOp{});
    CHECK(document().session.light.ambient != 0.125);
}

TEST_CASE_FIXTURE(AtDesk, "tracing: a cut is mended once, and nothing else is changed by what is refused")
{
    Tracer& tracer = services.tracer;
    CHECK(has(refusal([&] { tracer.act(MendCut{}); }), "cut nothing in two"));
    for (const double x : {8.0, 16.0, 24.0}) tracer.act(NodeOp{.at = {x, 18, 16}, .radius_voxels = {}, .group = {}});
    CHECK(trace().internodes().size() == 2);
    const size_t before = steps();
    CHECK(has(refusal([&] {
                  tracer.act(NodeOp{.at = {9, 9, 9}, .radius_voxels = {}, .group = uint8_t(0)});
              }),
              "Group 0 is the eraser"));
    CHECK(has(refusal([&] { tracer.act(GroupOp{.group = 0}); }), "Group 0 is the eraser"));
    CHECK_FALSE(refusal([&] { tracer.act(LinkOp{.near = {}, .node = uint32_t(77)}); }).empty());
    CHECK(steps() == before);
    CHECK(trace().nodes().size() == 3);

    tracer.act(SelectOp{.near = glm::dvec3(16, 18, 16), .number = {}, .within_voxels = {}});
    tracer.act(DeleteOp{});
    CHECK(trace().nodes().size() == 2);
    CHECK(trace().internodes().empty());
    CHECK(trace().selection().node());
    tracer.act(MendCut{});
    CHECK(trace().internodes().size() == 1);
    CHECK(has(refusal([&] { tracer.act(MendCut{}); }), "cut nothing in two"));
    CHECK(steps() == before + 2);
}

TEST_CASE_FIXTURE(AtDesk, "view: kept cameras have names of their own, and looking around is no step")
{
    Viewer& viewer = services.viewer;
    std::map<std::string, CameraSpec>& kept = document().session.cameras;
    const size_t before = kept.size();
    viewer.act(KeepCamera{});
    viewer.act(KeepCamera{});
    CHECK((kept.contains("view 1") && kept.contains("view 2")));
    CHECK(has(refusal([&] { viewer.act(RenameCamera{"view 1", "view 2"}); }), "is no free name"));
    CHECK(has(refusal([&] { viewer.act(RenameCamera{"nowhere", "view 3"}); }), "no view is kept"));
    CHECK(has(refusal([&] { viewer.act(ForgetCamera{"nowhere"}); }), "no view is kept"));
    CHECK(kept.size() == before + 2);
    viewer.act(ForgetCamera{"view 1"});
    viewer.act(KeepCamera{});
    CHECK(kept.contains("view 1"));
    services.settings.act(EndStep{});

    const size_t done = steps();
    const Camera camera = document().camera;
    CHECK_FALSE(refusal([&] { viewer.act(LookFrom{"nowhere"}); }).empty());
    CHECK(has(refusal([&] { viewer.act(PlaceClips{.near = 3.0, .far = 2.0}); }), "expected less than the far"));
    CHECK(has(refusal([&] { viewer.act(LookAtSelection{}); }), "Nothing is selected"));
    CHECK(document().camera == camera);
    viewer.act(Orbit{90.0, 0.0});
    services.settings.act(EndStep{});
    CHECK(document().camera != camera);
    CHECK(steps() == done);
}

TEST_CASE_FIXTURE(AtDesk, "view: cutting planes stay in the volume and never pass each other")
{
    const CutBox& cut = document().session.cut;
    services.viewer.act(MoveCut{.axis = 0, .upper = false, .share = -1.0});
    CHECK(cut.lower.x == 0.0);
    services.viewer.act(MoveCut{.axis = 0, .upper = true, .share = -0.5});
    CHECK(cut.upper.x == 20.0);
    services.viewer.act(MoveCut{.axis = 0, .upper = false, .share = 0.9});
    CHECK(cut.lower.x == 20.0);
    services.viewer.act(MoveCut{.axis = 0, .upper = true, .share = 5.0});
    CHECK(cut.upper.x == 40.0);
}

TEST_CASE_FIXTURE(AtDesk, "settings: what is refused changes nothing, one drag is one step, and a discard is known")
{
    SettingsEditor& settings = services.settings;
    const double before = document().session.light.ambient;
    const Session whole = document().session;
    CHECK_FALSE(refusal([&] { set(R"({"light":{"ambient":0.5, "sunshine":1}})"); }).empty());
    CHECK_FALSE(refusal([&] { set(R"({"probe":{"radius_voxels":-3}})"); }).empty());
    CHECK((document().session == whole));
    CHECK(steps() == 0);

    settings.set_hand_down(true);
    for (const char* const patch :
         {R"({"light":{"ambient":0.25}})", R"({"light":{"ambient":0.375}})", R"({"light":{"ambient":0.125}})"}) {
        set(patch);
        settings.advance();
    }
    CHECK(settings.has_settings_to_record());
    settings.set_hand_down(false);
    for (int turn = 0; turn < 2; ++turn) settings.advance();
    CHECK_FALSE(settings.has_settings_to_record());
    CHECK(steps() == 1);
    settings.act(UndoOp{});
    CHECK(document().session.light.ambient == before);
    settings.act(UndoOp{});
    CHECK(says("Nothing to undo"));
    settings.act(RedoOp{});
    CHECK(document().session.light.ambient == 0.125);

    CHECK_FALSE(settings.is_discarded());
    settings.discard();
    CHECK(document().session.light.ambient == before);
    CHECK(settings.is_discarded());
    set(R"({"light":{"ambient":0.5}})");
    CHECK_FALSE(settings.is_discarded());
}

TEST_CASE_FIXTURE(AtDesk, "touch: without a stylus, what needs one is refused, and letting go needs none")
{
    Hand& hand = services.hand;
    CHECK(has(refusal([&] { hand.act(GrabVolume{true}); }), "no stylus moves the probe"));
    CHECK(has(refusal([&] { hand.act(UseDevice{"unknown"}); }), "haptic device unknown: is not there"));
    CHECK(has(refusal([&] { hand.act(CalibrateDevice{}); }), "no haptic device is in use"));
    CHECK(has(refusal([&] { hand.act(RecordStylus{}); }), "no device runs here"));
    CHECK(has(refusal([&] { hand.act(StopRecording{}); }), "nothing is being recorded"));
    hand.act(GrabVolume{false});
    CHECK_FALSE(hand.model().hand->is_let_go);
    hand.act(LetGo{true});
    CHECK(hand.model().hand->is_let_go);
    CHECK(says("Let go"));
    const size_t count = desk.messages.all().size();
    hand.act(LetGo{true});
    CHECK(desk.messages.all().size() == count);
    hand.act(LetGo{false});
    CHECK_FALSE(hand.model().hand->is_let_go);
    services.painter.act(Paint{true});
    CHECK(has(refusal([&] { hand.act(FollowStylus{.path = folder.path / "a.trace"}); }), "a stroke is being painted"));
}
