#include "ui/keys.h"

#include <cstring>
#include <set>
#include <tuple>

#include <doctest/doctest.h>

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
    std::vector<Screen::Part> panes;
    PaintOp brush;
    Model model{.session = session,
                .volume = volume,
                .statistics = statistics,
                .panes = panes,
                .brush = brush,
                .pass_times = {}};
};

Actions actions_of(const World& world, int key, int mods, bool repeated = false)
{
    Actions actions;
    key_pressed({.key = key, .mods = mods, .pressed = true, .repeated = repeated}, world.model, actions);
    return actions;
}

/// The only action of a key, which must be of that type.
template <class Expected>
Expected only(const Actions& actions)
{
    REQUIRE(actions.size() == 1);
    REQUIRE(std::holds_alternative<Expected>(actions[0]));
    return std::get<Expected>(actions[0]);
}

std::string name_of_binding(const char* name)
{
    for (const KeyBinding& binding : key_bindings())
        if (std::strcmp(binding.name, name) == 0) return name_of(binding);
    return "(no such binding)";
}

}  // namespace

TEST_CASE("every key has a name and a group, and every name is given once")
{
    std::set<std::string> names;
    for (const KeyBinding& binding : key_bindings()) {
        CAPTURE(binding.key);
        CHECK(std::strlen(binding.name) > 0);
        CHECK(std::strlen(binding.group) > 0);
        CHECK(names.insert(binding.name).second);
        CHECK((binding.action || std::strcmp(binding.name, "Paint while held") == 0));
    }
}

TEST_CASE("no two bindings answer to the same key and modifiers")
{
    std::set<std::tuple<int, int>> taken;
    for (const KeyBinding& binding : key_bindings()) {
        CAPTURE(binding.name);
        CHECK(taken.insert({binding.key, binding.mods}).second);
        if (binding.is_slowed) CHECK(taken.insert({binding.key, binding.mods | SHIFT}).second);
    }
}

TEST_CASE("the bindings of a group stand together, so that its heading is shown once")
{
    std::set<std::string> seen;
    std::string group;
    for (const KeyBinding& binding : key_bindings()) {
        if (group == binding.group) continue;
        group = binding.group;
        CHECK_MESSAGE(seen.insert(group).second, group);
    }
}

TEST_CASE("Ctrl + Z undoes and Ctrl + Shift + Z redoes, also while the keyboard repeats them")
{
    const World world;
    for (const bool repeated : {false, true}) {
        only<Undo>(actions_of(world, 'Z', CONTROL, repeated));
        only<Redo>(actions_of(world, 'Z', CONTROL | SHIFT, repeated));
    }
    CHECK(actions_of(world, 'Z', 0).empty());
    CHECK(actions_of(world, 'Z', CONTROL | ALT).empty());
    only<Undo>(actions_of(world, 'Z', CONTROL | CAPS_LOCK));
}

TEST_CASE("a key that goes up, or that the keyboard repeats, does nothing")
{
    const World world;
    Actions actions;
    key_pressed({.key = 'W', .pressed = false}, world.model, actions);
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

TEST_CASE("digits choose colour groups, and F is left to the application")
{
    const World world;
    for (int group = 0; group <= 9; ++group)
        CHECK(int{only<ChooseGroup>(actions_of(world, '0' + group, 0)).group} == group);
    CHECK(actions_of(world, 'F', 0).empty());
}

TEST_CASE("End goes through all brushes and keeps the rest of the brush")
{
    World world;
    world.brush = {.brush = Brush::fill, .group = 7, .threshold = 12.0, .path = {glm::dvec3(1.0)}};
    const int end = 269;
    std::set<Brush> seen;
    for (int i = 0; i < 3; ++i) {
        world.brush = only<SetBrush>(actions_of(world, end, 0)).brush;
        seen.insert(world.brush.brush);
    }
    CHECK(seen.size() == 3);
    CHECK(world.brush.brush == Brush::fill);
    CHECK(world.brush.threshold == 12.0);
    CHECK(world.brush.path.empty());
}

TEST_CASE("cutting planes move inwards, and outwards with Ctrl")
{
    const World world;
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

TEST_CASE("keys are spelled as a person would")
{
    CHECK(name_of_binding("Redo") == "Ctrl + Shift + Z");
    CHECK(name_of_binding("Turn up") == "Alt + W");
    CHECK(name_of_binding("Guide the probe") == "Space");
    CHECK(name_of_binding("Larger probe") == "Page Up");
    CHECK(name_of_binding("Larger brush") == "]");
    CHECK(name_of_binding("Keys and mouse") == "F12");
}
