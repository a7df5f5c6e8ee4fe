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

TEST_CASE_FIXTURE(SettingsAlone, "settings: a drag is one message, which follows it and replaces no other")
{
    const size_t before = desk.messages.all().size();
    const auto texts = [&] {
        std::string all;
        for (size_t i = before; i < desk.messages.all().size(); ++i) all += desk.messages.all()[i].text + "\n";
        return all;
    };
    const auto drag_to = [&](int voxel) {
        set(sentence(R"({"cut":{"upper":[)", voxel, ",1048576,1048576]}}").c_str());
        settings.advance();
    };
    settings.set_hand_down(true);
    drag_to(30);
    const double begun_s = desk.messages.all().back().time_s;
    later_s += 60.0;
    drag_to(25);
    drag_to(20);
    CHECK(texts() == "Moved the far x cutting plane to voxel 20\n");
    CHECK(desk.messages.all().back().time_s >= begun_s + 60.0);
    desk.say("careful", Weight::warning);
    drag_to(19);
    drag_to(18);
    const std::string first =
        "Moved the far x cutting plane to voxel 20\ncareful\nMoved the far x cutting plane to voxel 18\n";
    CHECK(texts() == first);
    settings.set_hand_down(false);
    settings.advance();
    settings.advance();
    CHECK(settings.model().undoable == 1);
    // The next drag is another message, and one that ends where it began has done nothing.
    settings.set_hand_down(true);
    drag_to(15);
    CHECK(texts() == first + "Moved the far x cutting plane to voxel 15\n");
    drag_to(18);
    CHECK(texts() == first + "Everything is as it was\n");
    drag_to(12);
    settings.act(EndStep{});  // two steps are two sentences
    drag_to(10);
    CHECK(texts() ==
          first + "Moved the far x cutting plane to voxel 12\n" + "Moved the far x cutting plane to voxel 10\n");
}

TEST_CASE_FIXTURE(SettingsAlone, "settings: hiding a group adds none, and the action New group does")
{
    set(R"({"groups":{"3":{"visible":false}}})");
    CHECK(said() == "Hid group 3");
    settings.act(UndoOp{});
    CHECK(said() == "Undone: hid group 3");
    settings.act(NewGroup{});
    settings.act(UndoOp{});
    CHECK(said() == "Undone: added group 1");
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
