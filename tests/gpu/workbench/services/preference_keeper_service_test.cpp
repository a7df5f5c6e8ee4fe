// The keeper of preferences, alone: keys that a person binds, and keys that stand for something already.

#include <doctest/doctest.h>

#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

const Action BRIGHT = Set{R"({"light":{"ambient":0.4}})"};

/// The id of the shortcut, or the action as text, that a key stands for; empty: nothing.
std::string meaning_of(const PreferenceKeeper& keeper, const char* chord)
{
    if (const Action* const bound = keeper.keymap().action_for(*chord_of(chord))) return text_of(*bound);
    const Shortcut* const shortcut = keeper.keymap().shortcut_for(*chord_of(chord));
    return shortcut ? shortcut->id : "";
}

}  // namespace

TEST_CASE_FIXTURE(DeskWithScan, "a free key stands for what a person binds to it, which is told by name")
{
    const std::string id = text_of(BRIGHT);
    keeper.act(AwaitKey{id});
    CHECK(said() == "Press the key for 'Ambient light: 0.4'; Escape keeps its key, Delete removes it");
    keeper.act(BindKeys{id, "Ctrl+Shift+U"});
    CHECK(said() == "The key Ctrl + Shift + U stands for 'Ambient light: 0.4'");
    CHECK(keeper.awaits_key().empty());
    CHECK(meaning_of(keeper, "Ctrl+Shift+U") == id);
    keeper.act(BindKeys{id, ""});
    CHECK(said() == "'Ambient light: 0.4' has no key");
    CHECK(keeper.preferences().keys.empty());
    CHECK_THROWS_AS(keeper.act(AwaitKey{"no_such_thing"}), Error);
    CHECK_THROWS_AS(keeper.act(BindKeys{"undo", "Ctrl+"}), Error);
}

TEST_CASE_FIXTURE(DeskWithScan, "a key that stands for something is told, and taken over when it is pressed again")
{
    const std::string id = text_of(BRIGHT);
    keeper.act(AwaitKey{id});
    keeper.act(BindKeys{id, "Ctrl+S"});
    CHECK(said() ==
          "The key Ctrl + S stands for 'Save'; press it again to give it to 'Ambient light: 0.4', or Escape "
          "to leave it");
    CHECK(keeper.model().key_question == said());
    CHECK(keeper.awaits_key() == id);
    CHECK(meaning_of(keeper, "Ctrl+S") == "save");

    keeper.act(BindKeys{id, "Ctrl+Z"});  // another one, which is asked for, too
    CHECK(meaning_of(keeper, "Ctrl+Z") == "undo");
    keeper.act(AwaitKey{});
    CHECK(keeper.model().key_question.empty());
    CHECK(keeper.preferences().keys.empty());

    keeper.act(AwaitKey{id});
    for (int press = 0; press < 2; ++press) keeper.act(BindKeys{id, "Ctrl+S"});
    CHECK(said() == "The key Ctrl + S stands for 'Ambient light: 0.4', no longer for 'Save'");
    CHECK(meaning_of(keeper, "Ctrl+S") == id);
    CHECK(keeper.keymap().chords_of("save").empty());
    CHECK(keeper.keymap().conflicts().empty());

    // By a script or the button Reset: at once, and the other one has no key any more.
    keeper.act(BindKeys{"save", "Ctrl+S"});
    CHECK(said() == "The key Ctrl + S stands for 'Save', no longer for 'Ambient light: 0.4'");
    CHECK(meaning_of(keeper, "Ctrl+S") == "save");
    CHECK(keeper.preferences().keys.empty());
    // Only the keys in question are lost.
    keeper.act(BindKeys{"undo", "Ctrl+Y F5"});
    CHECK(meaning_of(keeper, "Ctrl+Shift+Z") == "redo");
    CHECK(keeper.keymap().chords_of("preview").empty());
    CHECK(keeper.keymap().conflicts().empty());
}
