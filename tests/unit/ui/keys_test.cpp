#include "ui/keys.h"

#include <cmath>
#include <cstring>
#include <set>
#include <tuple>

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/session/session_patch.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/appearance/layout.h"
#include "engine/workbench/bindings/palette.h"
#include "engine/workbench/bindings/tools.h"
#include "engine/workbench/edits/group_steps.h"
#include "engine/workbench/models/preferences.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

// GLFW's codes: letters are ASCII.
constexpr int SHIFT = 1, CONTROL = 2, ALT = 4, CAPS_LOCK = 16;

/// Everything that a model refers to.
struct World {
    Session session;
    VolumeInfo volume;
    VolumeStatistics statistics;
    Camera camera;
    std::vector<Screen::Part> panes;
    std::vector<TransferPreset> presets;
    TraceGraph trace;
    std::filesystem::path path;
    MessageLog messages;
    Keymap keymap;
    Preferences preferences;
    Model model{{.is_open = true,
                 .session = session,
                 .volume = volume,
                 .statistics = statistics,
                 .camera = camera,
                 .session_path = path,
                 .messages = messages},
                {.panes = panes},
                {},
                {},
                {},
                {},
                {},
                {.trace = trace},
                {},
                {},
                {},
                {},
                {},
                {.keymap = keymap, .preferences = preferences},
                {.presets = presets},
                {},
                {}};
};

Actions actions_of(const World& world, int key, int mods, bool repeated = false, const std::string& character = {})
{
    Keyboard keyboard;
    Actions actions;
    keyboard.handle({.key = key, .mods = mods, .pressed = true, .repeated = repeated, .character = character},
                    world.model, false, actions);
    return actions;
}

/// The only action of a key, which must be of that type.
template <class Expected>
Expected only(const Actions& actions)
{
    REQUIRE(actions.size() == 1);
    REQUIRE(actions[0].is<Expected>());
    return *actions[0].as<Expected>();
}

/// The session as the key's setting leaves it.
Session after(const World& world, int key, int mods = 0)
{
    return patched(world.session, only<Set>(actions_of(world, key, mods)).patch);
}

std::string keys_of(const char* id, const Keymap& keymap)
{
    const Shortcut* const shortcut = shortcut_named(id);
    return shortcut ? keymap.text_of(*shortcut) : "(no such shortcut)";
}

}  // namespace

TEST_CASE("every shortcut has a name, a group and an id of its own")
{
    std::set<std::string> names, ids;
    for (const Shortcut& shortcut : shortcuts()) {
        CAPTURE(shortcut.id);
        CHECK(std::strlen(shortcut.name) > 0);
        CHECK(std::strlen(shortcut.group) > 0);
        CHECK(names.insert(shortcut.name).second);
        CHECK(ids.insert(shortcut.id).second);
        CHECK((shortcut.action != nullptr));
    }
}

TEST_CASE("in both sets no two shortcuts answer to the same press")
{
    for (const KeySet set : {KeySet::modern, KeySet::thesis}) {
        const Keymap keymap(set);
        CHECK(keymap.conflicts().empty());
        for (const Shortcut& shortcut : shortcuts())
            for (Chord chord : keymap.chords_of(shortcut)) {
                CAPTURE(shortcut.id);
                CHECK(keymap.shortcut_for(chord) == &shortcut);
                CHECK(keymap.holders_of(chord) == std::vector<std::string>{shortcut.id});
                chord.shift = true;
                if (shortcut.is_slowed() && keymap.holders_of(chord).empty())
                    CHECK(keymap.shortcut_for(chord) == &shortcut);
            }
    }
}

TEST_CASE("the shortcuts of a group stand together, so that its heading is shown once")
{
    std::set<std::string> seen;
    std::string group;
    for (const Shortcut& shortcut : shortcuts()) {
        if (group == shortcut.group) continue;
        group = shortcut.group;
        CHECK_MESSAGE(seen.insert(group).second, group);
    }
}

TEST_CASE("the thesis's set has the keys of its appendix C, and today's set those that everybody knows")
{
    const Keymap thesis(KeySet::thesis), modern(KeySet::modern);
    for (const auto& [id, keys] : std::map<const char*, const char*>{{"undo", "Ctrl + Z"},
                                                                     {"redo", "Ctrl + Shift + Z"},
                                                                     {"add_node", "N"},
                                                                     {"drag_node", "M"},
                                                                     {"link_nearest", ","},
                                                                     {"select_nearest", "."},
                                                                     {"deselect", "/"},
                                                                     {"delete_selected", "Delete"},
                                                                     {"group_7", "7"},
                                                                     {"regroup_0", "Ctrl + 0"},
                                                                     {"next_brush", "End"},
                                                                     {"larger_brush", "]"},
                                                                     {"guide", "Space"},
                                                                     {"next_mode", "Home"},
                                                                     {"larger_probe", "Page Up"},
                                                                     {"turn_up", "Alt + W"},
                                                                     {"move_back", "S"},
                                                                     {"later_blending", "R"},
                                                                     {"sooner_blending", "Ctrl + R"},
                                                                     {"more_blending", "T"},
                                                                     {"near_x_out", "Ctrl + Y"},
                                                                     {"far_z_in", "K"},
                                                                     {"screenshot", "P"},
                                                                     {"larger_selected", "="},
                                                                     {"smaller_nodes", "Alt + -"},
                                                                     {"near_clip_closer", "Ctrl + C"},
                                                                     {"far_clip_away", "Ctrl + V"},
                                                                     {"shell", "F4"},
                                                                     {"update_occlusion", "F8"},
                                                                     {"overview", "F9"},
                                                                     {"single_view", "F10"},
                                                                     {"stereo", "F11"}}) {
        CAPTURE(id);
        CHECK(keys_of(id, thesis) == keys);
    }
    const auto means = [&](const char* keys, const char* id) {
        const Shortcut* const found = modern.shortcut_for(*chord_of(keys));
        REQUIRE(found);
        CHECK(std::string(found->id) == id);
    };
    means("Ctrl+Y", "redo");
    means("Ctrl+Shift+Z", "redo");
    means("F1", "help");
    means("F11", "full_screen");
    means("Ctrl+C", "copy_measurements");
    means("Alt+Up", "probe_away");
    // Letters that are typed by mistake cut and blend nothing, and write no file.
    for (const char* letter : {"C", "H", "I", "J", "K", "P", "R", "T", "U", "V", "Y"}) {
        CAPTURE(letter);
        CHECK(modern.shortcut_for(*chord_of(letter)) == nullptr);
    }
    CHECK(modern.shortcut_for(*chord_of("Ctrl+V")) == nullptr);
}

TEST_CASE("a person's keys replace those that ship, and a chord that means two things is named")
{
    const Keymap keymap(KeySet::modern, {{"undo", {"Ctrl+U"}}, {"save", {}}, {"redo", {"F5", "Ctrl+R"}}});
    CHECK(keys_of("undo", keymap) == "Ctrl + U");
    CHECK(keys_of("save", keymap).empty());
    CHECK(keymap.shortcut_for(*chord_of("Ctrl+Z")) == nullptr);
    REQUIRE(keymap.conflicts().size() == 1);
    CHECK(keymap.conflicts()[0] == "F5 stands for 'Redo' and for 'Preview of the brush'; change one of them");
    CHECK_THROWS_WITH(Keymap(KeySet::modern, {{"undoo", {"Ctrl+U"}}}),
                      "keys: 'undoo' is no shortcut; expected one listed in the help window, or an action");
    CHECK_THROWS_WITH(Keymap(KeySet::modern, {{"undo", {"Ctrl+"}}}),
                      "keys: undo is 'Ctrl+'; expected a key such as Ctrl+Z, F5, PageUp or [");
    for (const char* bad : {"", "Ctrl", "ctrl+Z", "Z+Ctrl", "F26", "F0", "ZZ", "z", "Shift+Ctrl+Z"}) {
        CAPTURE(bad);
        CHECK_FALSE(chord_of(bad));
    }
}

TEST_CASE("letters are those of the person's keyboard, and steering keys stay at their place")
{
    const World world;
    // QWERTZ: the key at the place of Y bears Z.
    only<UndoOp>(actions_of(world, 'Y', CONTROL, false, "z"));
    only<RedoOp>(actions_of(world, 'Z', CONTROL, false, "y"));
    // AZERTY: the key at the place of W bears Z, that at the place of Q bears A.
    CHECK(only<Move>(actions_of(world, 'W', 0, false, "z")).heights.z > 0.0);
    CHECK(only<Move>(actions_of(world, 'Q', 0, false, "a")).heights.y < 0.0);
    // Brackets need AltGr on both: keys with an umlaut, or a sign without a meaning, act as on an American keyboard.
    const auto factor_of = [&](int key, const char* sign) {
        return only<ScaleProbe>(actions_of(world, key, 0, false, sign)).factor;
    };
    for (const char* sign : {"\u00fc", "^"}) CHECK(factor_of('[', sign) == factor_of('[', "["));
    for (const char* sign : {"+", "$"}) CHECK(factor_of(']', sign) == factor_of(']', "]"));
    CHECK(actions_of(world, 'Q', SHIFT | CONTROL | ALT, false, "a").empty());  // a letter is that letter
    // and digits need Shift there
    CHECK(after(world, '3').probe.brush.group == 3);
    CHECK(patched(world.session, only<Set>(actions_of(world, '3', 0, false, "\"")).patch).probe.brush.group == 3);
}

TEST_CASE("F paints and M moves a node until they are released, whatever has the keyboard by then")
{
    const World world;
    Keyboard keyboard;
    for (const int key : {int('F'), int('M')}) {
        Actions actions;
        keyboard.handle({.key = key, .pressed = true}, world.model, false, actions);
        keyboard.handle({.key = key, .pressed = true, .repeated = true}, world.model, false, actions);
        REQUIRE(actions.size() == 1);
        keyboard.handle({.key = key}, world.model, true, actions);
        REQUIRE(actions.size() == 2);
        const bool is_paint = key == 'F';
        CHECK((is_paint ? actions[0].as<Paint>()->on : actions[0].as<DragNode>()->on));
        CHECK_FALSE((is_paint ? actions[1].as<Paint>()->on : actions[1].as<DragNode>()->on));
        // A key whose release was never seen, since the window was left.
        keyboard.handle({.key = key, .pressed = true}, world.model, false, actions);
        keyboard.hold(
            0.1, 0, [](int) { return false; }, world.model, actions);
        CHECK(actions.size() == 4);
    }
}

TEST_CASE("while text is typed, keys mean nothing here")
{
    const World world;
    Keyboard keyboard;
    Actions actions;
    keyboard.handle({.key = 'N', .pressed = true}, world.model, true, actions);
    keyboard.handle({.key = 'N'}, world.model, true, actions);
    CHECK(actions.empty());
}

TEST_CASE("keys that are held go on, five times a second, and slowly with Shift")
{
    const World world;
    Keyboard keyboard;
    Actions actions;
    const auto is_down = [](int) { return true; };
    keyboard.handle({.key = 'W', .pressed = true}, world.model, false, actions);
    actions.clear();
    keyboard.hold(0.1, 0, is_down, world.model, actions);
    CHECK(only<Move>(actions).heights.z == doctest::Approx(0.05 * 0.5));
    actions.clear();
    keyboard.hold(0.1, SHIFT, is_down, world.model, actions);
    CHECK(only<Move>(actions).heights.z == doctest::Approx(0.05 * 0.1));
    actions.clear();
    keyboard.hold(0.1, CONTROL, is_down, world.model, actions);
    CHECK(actions.empty());
    // Ctrl + S, and Ctrl is released first.
    keyboard.handle({.key = 'W'}, world.model, false, actions);
    keyboard.handle({.key = 'S', .mods = CONTROL, .pressed = true}, world.model, false, actions);
    actions.clear();
    keyboard.hold(0.1, 0, is_down, world.model, actions);
    CHECK(actions.empty());
}

TEST_CASE("Ctrl + Z undoes and Ctrl + Shift + Z redoes, also while the keyboard repeats them")
{
    const World world;
    for (const bool repeated : {false, true}) {
        only<UndoOp>(actions_of(world, 'Z', CONTROL, repeated));
        only<RedoOp>(actions_of(world, 'Z', CONTROL | SHIFT, repeated));
    }
    CHECK(actions_of(world, 'Z', 0).empty());
    CHECK(actions_of(world, 'Z', CONTROL | ALT).empty());
    only<UndoOp>(actions_of(world, 'Z', CONTROL | CAPS_LOCK));
}

TEST_CASE("a key that goes up, or that the keyboard repeats, does nothing")
{
    const World world;
    Keyboard keyboard;
    Actions actions;
    keyboard.handle({.key = 'W', .pressed = false}, world.model, false, actions);
    CHECK(actions.empty());
    CHECK(actions_of(world, 'W', 0, true).empty());
    CHECK(actions_of(world, ' ', 0, true).empty());
}

TEST_CASE("Shift slows a key to a fifth")
{
    const World world;
    const double tap = only<Move>(actions_of(world, 'W', 0)).heights.z;
    CHECK(tap == doctest::Approx(0.05));
    CHECK(only<Move>(actions_of(world, 'W', SHIFT)).heights.z == doctest::Approx(tap / 5));
    CHECK(only<Orbit>(actions_of(world, 'W', ALT)).up_degrees == doctest::Approx(3.0));
    CHECK(only<Orbit>(actions_of(world, 'W', ALT | SHIFT)).up_degrees == doctest::Approx(0.6));
}

TEST_CASE("digits choose colour groups")
{
    World world;
    world.session.probe.brush.group = 77;
    for (int group = 0; group <= 9; ++group) CHECK(int{after(world, '0' + group).probe.brush.group} == group);
}

TEST_CASE("End goes through all brushes and keeps the rest of the brush")
{
    World world;
    BrushSettings& brush = world.session.probe.brush;
    brush = {.brush = Brush::fill, .group = 7, .threshold = 12.0};
    const int end = 269;
    std::set<Brush> seen;
    for (int i = 0; i < 3; ++i) {
        brush = after(world, end).probe.brush;
        seen.insert(brush.brush);
    }
    CHECK(seen.size() == 3);
    CHECK(brush.brush == Brush::fill);
    CHECK(brush.threshold == 12.0);
}

namespace {

/// Three linked nodes 10 voxels apart along x, the last one selected; the probe near it.
void trace_three(World& world)
{
    world.volume.size = Size3(64);
    world.volume.spacing = {0.5, 0.5, 0.5};
    world.session.probe.brush.radius_voxels = 4.0;
    world.session.probe.brush.group = 2;
    for (uint32_t i = 0; i < 3; ++i)
        world.trace.apply(TraceNodeChange{i, {}, TraceNode{{5.0 + 5.0 * i, 5.0, 5.0}, 1.0, 2}}, Direction::forwards);
    for (uint32_t i = 0; i < 2; ++i)
        world.trace.apply(TraceInternodeChange{i, {}, TraceInternode{i, i + 1, 2}}, Direction::forwards);
    world.trace.select({{2}, {}});
    world.model.probe_voxel = world.model.tool_voxel = {29.0, 10.0, 10.0};
}

}  // namespace

TEST_CASE("keys of tracing become the operations that scripts have")
{
    World world;
    trace_three(world);
    const NodeOp node = only<NodeOp>(actions_of(world, 'N', 0));
    CHECK(node.at == glm::dvec3(29, 10, 10));
    CHECK(!node.radius_voxels.has_value());  // nodes have a radius of their own, not the brush's
    CHECK(node.group == uint8_t(2));
    const LinkOp link = only<LinkOp>(actions_of(world, ',', 0));
    CHECK(link.near == glm::dvec3(29, 10, 10));
    CHECK(link.within_voxels == 16.0);
    only<SelectSegmentOp>(actions_of(world, '.', SHIFT));
    only<DeselectOp>(actions_of(world, '/', 0));
    only<DeleteOp>(actions_of(world, 261, 0));
    CHECK(only<GroupOp>(actions_of(world, '4', CONTROL)).group == 4);
}

TEST_CASE("a full stop selects the nearest node, and where that is selected its internode")
{
    World world;
    trace_three(world);
    const SelectOp again = only<SelectOp>(actions_of(world, '.', 0));
    CHECK(again.is_internode);
    CHECK_FALSE(again.within_voxels);
    world.model.probe_voxel = world.model.tool_voxel = {12.0, 10.0, 10.0};
    const SelectOp other = only<SelectOp>(actions_of(world, '.', 0));
    CHECK_FALSE(other.is_internode);
    CHECK(other.within_voxels == 16.0);
    world.trace.select({});
    CHECK_FALSE(only<SelectOp>(actions_of(world, '.', 0)).is_internode);
}

TEST_CASE("equals and minus change what is selected, or the internodes of the group; with Alt its nodes")
{
    World world;
    trace_three(world);
    const RadiusOp larger = only<RadiusOp>(actions_of(world, '=', 0));
    CHECK((larger.of == RadiusOp::Of::selected));
    CHECK(larger.radius_voxels.value() == doctest::Approx(2.2));
    CHECK(only<RadiusOp>(actions_of(world, '-', 0)).radius_voxels.value() == doctest::Approx(2.0 / 1.1));
    CHECK(only<RadiusOp>(actions_of(world, '=', SHIFT)).radius_voxels.value() ==
          doctest::Approx(2.0 * std::pow(1.1, 0.2)));
    world.trace.select({});
    const RadiusOp internodes = only<RadiusOp>(actions_of(world, '=', 0));
    CHECK((internodes.of == RadiusOp::Of::internodes));
    CHECK(internodes.group == 2);
    CHECK(internodes.radius_voxels.value() == doctest::Approx(2.2));
    const RadiusOp nodes = only<RadiusOp>(actions_of(world, '=', ALT));
    CHECK((nodes.of == RadiusOp::Of::nodes));
    CHECK(nodes.group == 2);
}

TEST_CASE("X changes between tracing and turning, Alt and a digit take each tool")
{
    World world;
    CHECK((after(world, 'X').probe.tool == Tool::trace));
    world.session.probe.tool = Tool::trace;
    CHECK((after(world, 'X').probe.tool == Tool::turn));
    world.session.probe.tool = Tool::measure;
    int number = 0;
    for (const Tool tool : {Tool::turn, Tool::paint, Tool::erase, Tool::trace, Tool::select})
        CHECK((after(world, '1' + number++, ALT).probe.tool == tool));
    world.session.probe.tool = Tool::turn;
    CHECK((after(world, '6', ALT).probe.tool == Tool::measure));
}

TEST_CASE("The tool that erases paints with group 0 and leaves the active group as it is")
{
    ProbeSettings probe;
    probe.brush.group = 7;
    CHECK(probe.painted_group() == 7);
    probe.tool = Tool::erase;
    CHECK(probe.painted_group() == 0);
    CHECK(probe.brush.group == 7);
}

TEST_CASE("in the thesis's set cutting planes move inwards, and outwards with Ctrl")
{
    World world;
    world.keymap = Keymap(KeySet::thesis);
    const MoveCut lower = only<MoveCut>(actions_of(world, 'U', 0));
    CHECK(lower.axis == 1);
    CHECK_FALSE(lower.upper);
    CHECK(lower.share == doctest::Approx(0.01));
    const MoveCut upper = only<MoveCut>(actions_of(world, 'K', CONTROL));
    CHECK(upper.axis == 2);
    CHECK(upper.upper);
    CHECK(upper.share == doctest::Approx(0.01));
    CHECK(only<MoveCut>(actions_of(world, 'K', 0)).share == doctest::Approx(-0.01));
}

TEST_CASE("the key that a shortcut waits for is bound to it; Escape leaves it, Delete takes it away")
{
    World world;
    world.model.awaits_key = "shell";
    const auto bound = [&](int key, int mods, const std::string& character = {}) {
        const Actions actions = actions_of(world, key, mods, false, character);
        return actions.empty() ? std::string() : text_of(actions.at(0));
    };
    constexpr int ESCAPE = 256, DELETE = 261, LEFT_CONTROL = 341;
    CHECK(bound('J', CONTROL | SHIFT) == R"(bind_keys keys="Ctrl+Shift+J" shortcut="shell")");
    CHECK(bound('Y', CONTROL, "z") == R"(bind_keys keys="Ctrl+Z" shortcut="shell")");
    CHECK(bound(LEFT_CONTROL, CONTROL).empty());
    CHECK(bound(ESCAPE, 0) == text_of(AwaitKey{}));
    CHECK(bound(DELETE, 0) == text_of(BindKeys{"shell", ""}));
    CHECK(bound(DELETE, CONTROL) == R"(bind_keys keys="Ctrl+Delete" shortcut="shell")");
    world.model.awaits_key = "move_forward";  // by place
    CHECK(bound('Q', 0, "a") == R"(bind_keys keys="Q" shortcut="move_forward")");
    for (const Shortcut& shortcut : shortcuts())
        for (const Chord& chord : world.keymap.chords_of(shortcut)) CHECK(chord_of(text_of(chord)) == chord);
}

TEST_CASE("shortcuts with the same key know of each other")
{
    const Keymap keymap(KeySet::modern, {{"redo", {"F5", "Ctrl+R"}}});
    const auto rivals = keymap.rivals_of(*shortcut_named("redo"));
    REQUIRE(rivals.size() == 1);
    CHECK(std::string(rivals[0]->id) == "preview");
    CHECK(std::string(keymap.rivals_of(*rivals[0]).at(0)->id) == "redo");
    CHECK(keymap.rivals_of(*shortcut_named("undo")).empty());
}

TEST_CASE("a key does one thing: what a person bound to it, before what ships")
{
    constexpr int F5 = 294, F7 = 296;
    World world;
    world.keymap = Keymap(KeySet::modern, {{"redo", {"F5", "Ctrl+R"}},
                                           {"look_from camera=\"top\"", {"Ctrl+S", "F7"}},
                                           {"look_from camera=\"left\"", {"F7"}}});
    only<RedoOp>(actions_of(world, F5, 0));
    CHECK(only<LookFrom>(actions_of(world, 'S', CONTROL)).camera == "top");
    CHECK(actions_of(world, F7, 0).size() == 1);
    CHECK(world.keymap.conflicts().size() == 3);  // said at the start, since a hand wrote them into the file
    CHECK(world.keymap.holders_of(*chord_of("Ctrl+S")) == std::vector<std::string>{"save", "look_from camera=\"top\""});
    // While it is held, the shortcut that it took the place of does not go on.
    Keyboard keyboard;
    Actions actions;
    keyboard.handle({.key = F7, .pressed = true}, world.model, false, actions);
    keyboard.hold(
        0.1, 0, [](int) { return true; }, world.model, actions);
    CHECK(actions.size() == 1);
    // On a keyboard whose key at the place of W bears the name of another shortcut's key.
    only<LinkOp>(actions_of(world, 'W', 0, false, ","));
}

TEST_CASE("what is bound is called as a person calls it, without JSON and ids")
{
    const auto name = [](const Action& action) { return name_of_binding(text_of(action)); };
    CHECK(name(Set{R"({"light":{"ambient":0.4}})"}) == "Ambient light: 0.4");
    CHECK(name(Set{R"({"light":{"ambient":-0.0}})"}) == "Ambient light: 0");
    CHECK(name(Set{R"({"light":{"shaded":false}})"}) == "Shading: off");
    CHECK(name(Set{R"({"light":{"ambient":null}})"}) == "Ambient light: as by default");
    CHECK(name(Set{R"({"light":{"ambient":0.4,"diffuse":0.5,"specular":0}})"}) ==
          "Ambient light: 0.4 and 2 more settings");
    CHECK(name(Set{R"({"transfer_function":{"points":null,"preset":"haze"}})"}) == "Transfer function haze");
    CHECK(name(Set{R"({"transfer_function":{"points":[{"intensity":7,"opacity":0},{"intensity":9,"opacity":1}]}})"}) ==
          "Points of the transfer function: 2 points");
    CHECK(name(Set{R"({"probe":{"group":4}})"}) == "Group 4");
    CHECK(name(Set{R"({"probe":{"brush":"flood"}})"}) == "Flood fill");
    CHECK(name(Prefer{R"({"theme":"light"})"}) == "Theme: light");
    CHECK(name(Prefer{R"({"font_pixels":16})"}) == "Text: 16 pixels");
    CHECK(name(Prefer{R"({"layout":{"panels":{"light":{"place":"side"}}}})"}) == "Light and depth");
    CHECK(name(ChooseKeys{"thesis"}) == "Keys: from the SHVR thesis");
    CHECK(name(LookFrom{"top"}) == "Look from top");
    CHECK(name(TakeLook{"xylem"}) == "Look xylem");
    CHECK(name(ShowDialog{Dialog::operation, "fill_holes"}) == "Fill holes");
    CHECK(name(SelectOp{.near = {}, .number = 7, .within_voxels = {}}) == "Node 7");
    CHECK(name(Orbit{3.0, 0.0}).find("right degrees 3") != std::string::npos);
    CHECK(name_of_binding("save") == "Save");
    CHECK_THROWS_AS(name_of_binding("no_such_thing"), Error);
    CHECK(Keymap(KeySet::modern, {{text_of(LookFrom{"top"}), {"F5"}}}).bound().at(0).name == "Look from top");
}

TEST_CASE("any entry of the palette can have a key, which then makes its action")
{
    World world;
    world.model.is_open = true;
    const std::vector<PaletteEntry> entries = palette_entries(world.model, "shading");
    const auto shading = std::ranges::find(entries, "Shading: off", &PaletteEntry::name);
    REQUIRE(shading != entries.end());
    REQUIRE_FALSE(shading->bound_as.empty());
    CHECK(shading->keys.empty());
    world.keymap = Keymap(KeySet::modern, {{shading->bound_as, {"Ctrl+J"}}, {"look_from camera=\"top\"", {"Ctrl+U"}}});
    const Actions made = actions_of(world, 'J', CONTROL);
    REQUIRE(made.size() == 1);
    CHECK(text_of(made[0]) == shading->bound_as);
    CHECK(actions_of(world, 'J', 0).empty());
    CHECK(text_of(actions_of(world, 'U', CONTROL).at(0)) == text_of(LookFrom{"top"}));
    const std::vector<PaletteEntry> again = palette_entries(world.model, "shading");
    CHECK(std::ranges::find(again, "Shading: off", &PaletteEntry::name)->keys == "Ctrl + J");
    for (const PaletteEntry& entry : palette_entries(world.model, "top"))
        if (entry.action) CHECK_FALSE(entry.bound_as.empty());
    const Keymap rival(KeySet::modern, {{"look_from camera=\"top\"", {"Ctrl+Z"}}});
    REQUIRE(rival.conflicts().size() == 1);
    CHECK(rival.conflicts()[0].find("'Undo' and for 'Look from top'") != std::string::npos);
    CHECK_THROWS_AS(Keymap(KeySet::modern, {{"look_from", {"Ctrl+5"}}}), Error);
    CHECK_THROWS_AS(Keymap(KeySet::modern, {{"no_such_thing", {}}}), Error);
}

TEST_CASE("the palette finds shortcuts by words, actions by their text and settings by their keys")
{
    World world;
    CHECK(palette_entries(world.model, "").size() == shortcuts().size());
    const auto first = [&](const char* text) {
        const std::vector<PaletteEntry> entries = palette_entries(world.model, text);
        REQUIRE_FALSE(entries.empty());
        return entries.front();
    };
    CHECK(first("LARGE shot").name == "Large screenshot");
    CHECK(first("LARGE shot").keys == "Shift + F12");
    CHECK(first("undo ").why_not == "there is nothing to undo");
    CHECK(text_of(*first(" look_from camera=top").action) == text_of(LookFrom{"top"}));
    CHECK(first("look_from").why_not.find("camera") != std::string::npos);
    CHECK(first("orbit right_degrees=x").why_not.find("right_degrees") != std::string::npos);
    CHECK(first("light.ambient=0.4").action->as<Set>()->patch == R"({"light":{"ambient":0.4}})");
    CHECK(first("light.ambient=0.4").why_not.empty());
    CHECK(first("light.ambient=0,4").action->as<Set>()->patch == R"({"light":{"ambient":0.4}})");
    CHECK(first("light.ambient=0,4").name == "light.ambient=0.4");
    CHECK_FALSE(first("light.ambient=0,4,5").why_not.empty());
    CHECK(text_of(*first("orbit right_degrees=1,5 up_degrees=2").action) == "orbit right_degrees=1.5 up_degrees=2.0");
    CHECK(first("light.ambient=70").why_not.find("ambient") != std::string::npos);
    CHECK(first("light.ambiance=0.4").why_not.find("ambiance") != std::string::npos);
    CHECK(first("light.amb").completion == "light.ambient=");
    CHECK(first("look_f").completion == "look_from ");
    CHECK(first("paint while").why_not == "goes on while its key is held");
    CHECK(palette_entries(world.model, "no such thing at all").empty());
}

TEST_CASE("the palette finds panels and settings by words, values behind words, and what a scan lists")
{
    World world;
    world.model.is_open = true;
    const auto found = [&](const char* text, const std::string& name) {
        const std::vector<PaletteEntry> entries = palette_entries(world.model, text);
        const auto it = std::ranges::find(entries, name, &PaletteEntry::name);
        REQUIRE_MESSAGE(it != entries.end(), text, " does not find ", name);
        return *it;
    };
    for (const PanelRow& row : panel_rows()) {
        const PaletteEntry entry = found(row.title, row.title);
        CHECK(entry.action->as<Prefer>()->patch.find(row.id) != std::string::npos);
        CHECK(entry.action->as<Prefer>()->patch.find("\"folded\":false") != std::string::npos);
    }
    CHECK(found("ambient", "Ambient light").completion == "light.ambient=");
    CHECK(found("ambient 0.4", "Ambient light: 0.4").action->as<Set>()->patch == R"({"light":{"ambient":0.4}})");
    CHECK(found("ambient 0,4", "Ambient light: 0.4").action->as<Set>()->patch == R"({"light":{"ambient":0.4}})");
    for (const PaletteEntry& entry : palette_entries(world.model, "ambient 70"))
        CHECK_MESSAGE(entry.name != "Ambient light: 70", "a value out of range is offered");
    CHECK(found("pivot", "Pivot of turning: the probe").action->as<Set>()->patch ==
          R"({"interaction":{"pivot":"probe"}})");
    CHECK(found("shading", "Shading: off").action->as<Set>()->patch == R"({"light":{"shaded":false}})");
    CHECK(found("shading", "Shading: off").group == "Setting: light.shaded, now on");
    CHECK(found("import", "Import as project...").action->as<ShowDialog>()->dialog == Dialog::import_scan);
    CHECK(found("export", "Export...").action->as<ShowDialog>()->dialog == Dialog::export_work);
    CHECK(found("spacing", "Correct the spacing...").action->as<ShowDialog>()->dialog == Dialog::spacing);
    CHECK(found("label", "Label connected parts...").action->as<ShowDialog>()->dialog == Dialog::label);
    CHECK(found("load", "Load annotation...").action->as<ShowDialog>()->dialog == Dialog::load);
    CHECK(found("top", "Look from top").action->as<LookFrom>()->camera == "top");
    world.session.groups[4].name = "leaf trace";
    CHECK(found("leaf", "Group 4 leaf trace").action->is<Set>());
    CHECK(found("hide leaf", "Hide group 4 leaf trace").action->as<Set>()->patch ==
          R"({"groups":{"4":{"visible":false}}})");
    CHECK(found("lock group 4", "Lock group 4 leaf trace").action->as<Set>()->patch ==
          R"({"groups":{"4":{"locked":true}}})");
    world.session.groups[4].locked = true;
    CHECK(found("lock group 4", "Unlock group 4 leaf trace").action->as<Set>()->patch ==
          R"({"groups":{"4":{"locked":false}}})");
    for (const auto& [words, name] : {std::pair("mask", "Load annotation..."), std::pair("csv", "Export..."),
                                      std::pair("unit", "Correct the spacing..."),
                                      std::pair("memory", "Open with options..."), std::pair("video", "Movie...")})
        CHECK(found(words, name).action->is<ShowDialog>());
    for (const PaletteEntry& entry : palette_entries(world.model, "trans"))
        CHECK_MESSAGE(entry.name.find(".N") == std::string::npos, entry.name, " cannot be completed");
}

namespace {

/// The entry of that name among those that the palette finds; of several with one name, the first.
PaletteEntry found_in(const World& world, const std::string& text, const std::string& name)
{
    const std::vector<PaletteEntry> entries = palette_entries(world.model, text);
    const auto it = std::ranges::find(entries, name, &PaletteEntry::name);
    REQUIRE_MESSAGE(it != entries.end(), text, " does not find ", name);
    return *it;
}

}  // namespace

TEST_CASE("the palette finds all that the menus offer, whether it has a key or not")
{
    World world;
    for (const Shortcut& shortcut : shortcuts()) {
        if (*shortcut.keys[0]) continue;  // the others are found by the same lines
        const std::string name = shortcut.name;
        CHECK(found_in(world, name, name).bound_as == shortcut.id);
    }
    for (const char* words : {"OPEN the example", "copy SESSION", "revert save", "threshold group", "show everything",
                              "shading", "calibrate", "hints again", "over the shoulder", "load mesh"})
        CHECK_MESSAGE(!palette_entries(world.model, words).front().bound_as.empty(), words);
    for (const OperationRow& row : OPERATION_ROWS)
        for (const std::string& typed : {std::string(row.title), lower_case(row.title)}) {
            const PaletteEntry entry = found_in(world, typed, row.title);
            REQUIRE(entry.action->is<ShowDialog>());
            CHECK(entry.action->as<ShowDialog>()->operation == row.id);
        }
    CHECK(found_in(world, "lasso", "Cut by an outline").action->as<ShowDialog>()->operation == "lasso");
}

TEST_CASE("menus draw what the table of shortcuts has, so that the palette lacks none of it")
{
    // Items with names of their own are lists, which palette_lists.cpp has, too: recent files, views, panels, groups.
    const std::string menus = read_text("ui/panels/panel_menu.cpp", int64_t{1} << 20);
    CHECK(menus.find("MenuItem(\"") == std::string::npos);
}

TEST_CASE("the palette finds preferences and brushes by their labels, and sets a typed value")
{
    World world;
    CHECK(found_in(world, "light theme", "Theme: light").action->as<Prefer>()->patch == R"({"theme":"light"})");
    for (const char* label : {"Text", "Scale", "GPU memory", "Memory"})
        CHECK(found_in(world, lower_case(label), label).action->is<ShowPreferences>());
    CHECK(found_in(world, "text 16", "Text: 16 pixels").action->as<Prefer>()->patch == R"({"font_pixels":16})");
    CHECK(found_in(world, "gpu memory 1", "GPU memory").why_not ==
          "GPU memory: expected a number from 16 to 1048576 MiB");
    CHECK(found_in(world, "thesis keys", "Keys: from the SHVR thesis").action->is<ChooseKeys>());
    for (const BrushRow& row : BRUSHES) {  // the present one, too
        const PaletteEntry entry = found_in(world, row.title, row.title);
        CHECK(patched(world.session, entry.action->as<Set>()->patch).probe.brush.brush == row.brush);
    }
}

TEST_CASE("the palette finds settings by the words of the panels")
{
    World world;
    for (const auto& [words, title] : std::initializer_list<std::pair<const char*, const char*>>{
             {"Enlarged", "Zoom of the slices"},
             {"eyes apart", "Distance between the eyes"},
             {"Holds from", "Share of the probe's ball that holds it on a surface"},
             {"Opaque from", "Opacity at which rays end"},
             {"Background", "Background"},
             {"Fade below", "Gradient at which shading fades"},
             {"Map scale", "Scale of the maps"},
             {"Feels", "Groups that are felt"},
             {"Raise by", "Offset of density painting"},
             {"probe's colour", "Colour of the probe"}})
        CHECK_FALSE(found_in(world, words, title).completion.empty());
    for (const auto& [words, title] : std::initializer_list<std::pair<const char*, const char*>>{
             {"Touches", "Mode of touch: surface"},
             {"falls off", "Falloff of density painting: distance"},
             {"click at contact", "Clicks where contact begins: on"},
             {"two eyes", "Arrangement of the panes: stereo"}})
        CHECK(found_in(world, words, title).action->is<Set>());
    // A setting of names offers the present one, too: it may be what a key is wanted for.
    CHECK(found_in(world, "arrangement", "Arrangement of the panes: single").action->is<Set>());
    CHECK(found_in(world, "background #102030", "Background: #102030").action->is<Set>());
    CHECK(found_in(world, "shading OFF", "Shading: off").action->as<Set>()->patch == R"({"light":{"shaded":false}})");
}

TEST_CASE("the palette says which value a setting expects, and shows the value that it gets")
{
    World world;
    for (const char* value : {"1e400", "nan", "abc", "-1"})
        CHECK(found_in(world, sentence("ambient light ", value), "Ambient light").why_not ==
              "Ambient light: expected a number from 0 to 10");
    CHECK(found_in(world, "ambient abc", "Ambient light").bound_as.empty());
    CHECK(found_in(world, "shading 7", "Shading").why_not == "Shading: expected on or off");
    CHECK(found_in(world, "Ambient Light -0", "Ambient light: 0").why_not.empty());
    CHECK(palette_entries(world.model, "no such thing 7").empty());
}

TEST_CASE("a person's words come before ids of scripts, in any case")
{
    World world;
    for (const char* typed : {"grow", "Grow", "GROW"}) {
        const std::vector<PaletteEntry> entries = palette_entries(world.model, typed);
        REQUIRE_FALSE(entries.empty());
        CHECK(entries.front().name == "Grow");
        for (const PaletteEntry& entry : entries) CHECK_MESSAGE(entry.completion != "grow ", typed);
        for (const PaletteEntry& entry : entries)
            CHECK_MESSAGE(entry.why_not.find("group is missing") == std::string::npos, typed);
    }
    // Words are no arguments: how a script is written is not said.
    for (const PaletteEntry& entry : palette_entries(world.model, "group xyzzy"))
        CHECK(entry.why_not.find("argument") == std::string::npos);
    world.session.groups[4].name = "vessel";
    CHECK(palette_entries(world.model, "group vessel").front().name == "Group 4 vessel");
    // For scripts.
    const auto first = [&](const char* text) { return palette_entries(world.model, text).front(); };
    CHECK(first("grow group=1 distance=x").why_not.find("distance") != std::string::npos);
    CHECK(text_of(*first("Look_From camera=top").action) == text_of(LookFrom{"top"}));
    CHECK(first("LOOK_F").completion == "look_from ");
    CHECK(first("Light.Ambient=0.4").action->as<Set>()->patch == R"({"light":{"ambient":0.4}})");
    CHECK_FALSE(palette_entries(world.model, "=").empty());  // the key of a shortcut
}

TEST_CASE("Groups are stepped through with those in use, and a new one is the first without anything")
{
    World world;
    world.session.probe.brush.group = 9;
    world.model.voxels_by_group[42] = 5;
    constexpr int PAGE_UP = 266, PAGE_DOWN = 267;
    CHECK(after(world, PAGE_DOWN, ALT).probe.brush.group == 42);
    CHECK(after(world, PAGE_UP, ALT).probe.brush.group == 8);
    world.session.probe.brush.group = 42;
    CHECK(after(world, PAGE_DOWN, ALT).probe.brush.group == 1);
    world.session.probe.brush.group = 0;
    CHECK(after(world, PAGE_UP, ALT).probe.brush.group == 42);
    CHECK(after(world, PAGE_DOWN, ALT).probe.brush.group == 1);

    world.model.voxels_by_group[1] = 7;
    world.session.groups[2].name = "vein";
    world.session.groups[5].parent = 3;
    static_cast<void>(only<NewGroup>(actions_of(world, 'G', CONTROL)));
    CHECK(unused_group(world.model) == 4);
    world.model.voxels_by_group.fill(1);
    CHECK(unused_group(world.model) == 0);
}

TEST_CASE("Escape closes what is in front, and then the mouse turns again")
{
    constexpr int ESCAPE = 256;
    World world;
    world.session.probe.tool = Tool::paint;
    world.model.shows_preferences = world.model.shows_help = world.model.is_full_screen = true;
    CHECK_FALSE(only<ShowPreferences>(actions_of(world, ESCAPE, 0)).on);
    world.model.shows_preferences = false;
    CHECK_FALSE(only<ShowHelp>(actions_of(world, ESCAPE, 0)).on);
    world.model.shows_help = false;
    CHECK_FALSE(only<ShowFullScreen>(actions_of(world, ESCAPE, 0)).on);
    world.model.is_full_screen = false;
    CHECK((after(world, ESCAPE).probe.tool == Tool::turn));
}

TEST_CASE("Panels used by keyboard take arrows, Tab, Space, Enter and Escape, and no other key")
{
    for (const int key : {256, 257, 258, 262, 263, 264, 265, 32}) {
        CHECK(moves_in_panels({.key = key, .pressed = true}));
        CHECK_FALSE(moves_in_panels({.key = key, .mods = CONTROL, .pressed = true}));
        CHECK_FALSE(moves_in_panels({.key = key, .mods = ALT, .pressed = true}));
    }
    for (const int key : {int('X'), int('1'), 290, 268}) CHECK_FALSE(moves_in_panels({.key = key, .pressed = true}));
}

TEST_CASE("The bar tells what each tool's buttons do, and every tool has a key")
{
    const Keymap keymap;
    for (const ToolRow& row : tool_rows()) {
        REQUIRE(shortcut_named(row.shortcut) != nullptr);
        CHECK_FALSE(keymap.text_of(*shortcut_named(row.shortcut)).empty());
        CHECK(mouse_in_words(row.tool).find(row.left) != std::string::npos);
        CHECK(sentence_of(row.tool).starts_with(row.name));
    }
    CHECK(mouse_in_words(Tool::paint) == "left: paint, right or middle: turn, wheel: zoom");
    CHECK(mouse_in_words(Tool::turn) == "left: turn, right: zoom, middle: move, wheel: zoom");
    CHECK(mouse_in_words(Tool::trace, Pane::Kind::slice) ==
          "left: add / pick / drag, wheel: next slice, right: contrast, middle: move, Ctrl + wheel: zoom");
    CHECK(mouse_in_words(Tool::turn, Pane::Kind::slice).starts_with("left: set the cross-hairs, wheel: next slice"));
    CHECK(mouse_in_words(Tool::turn, Pane::Kind::main, KeySet::thesis) ==
          "left: turn, right: paint, middle: move, wheel: zoom");
    CHECK(mouse_in_words(Tool::turn, Pane::Kind::map).starts_with("left: turn"));
}
