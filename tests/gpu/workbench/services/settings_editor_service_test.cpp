// The editor of settings alone: which consequences each change has, and what is taken back.

#include <doctest/doctest.h>

#include "engine/workbench/services/settings_editor.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct SettingsAlone : DeskWithScan {
    std::string why_no_reload;
    SettingsEditor settings{desk,
                            {.look_again = notes("look_again"),
                             .show_cut_box = notes("show_cut_box"),
                             .stop_drag = notes("stop_drag"),
                             .finish_stroke =
                                 [this] {
                                     calls.emplace_back("finish_stroke");
                                     return std::string();
                                 },
                             .reload =
                                 [this](const RenderSettings&) {
                                     calls.emplace_back("reload");
                                     if (!why_no_reload.empty()) fail(why_no_reload);
                                 }}};
    void set(const char* patch) { settings.act(Set{patch}); }
};

}  // namespace

TEST_CASE_FIXTURE(SettingsAlone, "settings: each change asks for what it needs, and no more")
{
    set(R"({"light":{"ambient":0.125}})");
    CHECK(take_calls() == "look_again");
    set(R"({"probe":{"radius_voxels":3}})");
    CHECK(take_calls().empty());
    set(R"({"cut":{"upper":[20,36,32]}})");
    CHECK(take_calls() == "show_cut_box look_again");
    document().drags_node = true;
    set(R"({"probe":{"tool":"trace"}})");
    CHECK(take_calls() == "stop_drag");
    set(R"({"render":{"sampling":"hardware"}})");
    CHECK(take_calls() == "reload look_again");
}

TEST_CASE_FIXTURE(SettingsAlone, "settings: a reload that is refused leaves the session as it was")
{
    why_no_reload = "the device is full";
    const Session before = document().session;
    CHECK(error_of([&] { set(R"({"render":{"sampling":"hardware"}})"); }) == "the device is full");
    CHECK((document().session == before));
    CHECK_FALSE(settings.has_settings_to_record());
    CHECK(take_calls() == "reload");
}

TEST_CASE_FIXTURE(SettingsAlone, "settings: a change becomes a step when the hand rests, and undo takes it back")
{
    const double before = document().session.light.ambient;
    settings.set_hand_down(true);
    set(R"({"light":{"ambient":0.25}})");
    settings.advance();
    set(R"({"light":{"ambient":0.5}})");
    settings.advance();
    CHECK(settings.has_settings_to_record());
    settings.set_hand_down(false);
    settings.advance();
    settings.advance();
    CHECK_FALSE(settings.has_settings_to_record());
    CHECK(settings.model().undoable == 1);
    take_calls();
    settings.act(UndoOp{});
    CHECK(document().session.light.ambient == before);
    CHECK(take_calls() == "look_again");
    settings.act(RedoOp{});
    CHECK(document().session.light.ambient == 0.5);
}

TEST_CASE_FIXTURE(SettingsAlone, "settings: after an empty stroke the first undo changes nothing")
{
    set(R"({"light":{"ambient":0.25}})");
    settings.record_settings();
    settings.note_stroke(true);
    settings.act(UndoOp{});
    CHECK(document().session.light.ambient == 0.25);
    CHECK(says("nothing is undone"));
    settings.act(UndoOp{});
    CHECK(document().session.light.ambient != 0.25);
}

TEST_CASE_FIXTURE(SettingsAlone, "settings: the view is kept when the hand rests; discarding ends the stroke first")
{
    CHECK_FALSE(settings.has_view_to_keep());
    settings.note_to_keep();
    settings.advance();
    CHECK(settings.has_view_to_keep());
    later_s += 1.0;
    settings.advance();
    CHECK_FALSE(settings.has_view_to_keep());

    set(R"({"light":{"ambient":0.25}})");
    take_calls();
    settings.discard();
    CHECK(calls.front() == "finish_stroke");
    CHECK(document().session.light.ambient != 0.25);
    CHECK(settings.is_discarded());
    settings.begin_document();
    CHECK_FALSE(settings.is_discarded());
}
