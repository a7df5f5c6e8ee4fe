#include "ui/keys.h"

#include <cmath>
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
    std::vector<TransferPreset> presets;
    TraceGraph trace;
    Model model{.session = session,
                .volume = volume,
                .statistics = statistics,
                .panes = panes,
                .presets = presets,
                .trace = trace,
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
        const bool is_of_application = std::strcmp(binding.name, "Paint while held") == 0 ||
                                       std::strcmp(binding.name, "Move the selected node while held") == 0;
        CHECK((binding.action || is_of_application));
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
    BrushSettings& brush = world.session.probe.brush;
    brush = {.brush = Brush::fill, .group = 7, .threshold = 12.0};
    const int end = 269;
    std::set<Brush> seen;
    for (int i = 0; i < 3; ++i) {
        brush = only<SetBrush>(actions_of(world, end, 0)).brush;
        seen.insert(brush.brush);
    }
    CHECK(seen.size() == 3);
    CHECK(brush.brush == Brush::fill);
    CHECK(brush.threshold == 12.0);
}

namespace {

/// Three linked nodes 10 voxels apart along x, the last one selected; the probe beside it.
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
    world.model.probe_voxel = {29.0, 10.0, 10.0};
}

template <class Op>
Op only_trace(const Actions& actions)
{
    const TraceOp op = only<Trace>(actions).op;
    REQUIRE(std::holds_alternative<Op>(op));
    return std::get<Op>(op);
}

}  // namespace

TEST_CASE("keys of tracing become the operations that scripts have")
{
    World world;
    trace_three(world);
    const NodeOp node = only_trace<NodeOp>(actions_of(world, 'N', 0));
    CHECK(node.at == glm::dvec3(29, 10, 10));
    CHECK(node.radius_voxels == 4.0);
    CHECK(node.group == uint8_t(2));
    const LinkOp link = only_trace<LinkOp>(actions_of(world, ',', 0));
    CHECK(link.near == glm::dvec3(29, 10, 10));
    CHECK(link.within_voxels == 16.0);
    only_trace<SelectSegmentOp>(actions_of(world, '.', SHIFT));
    only_trace<DeselectOp>(actions_of(world, '/', 0));
    only_trace<DeleteOp>(actions_of(world, 261, 0));
    CHECK(only_trace<GroupOp>(actions_of(world, '4', CONTROL)).group == 4);
    CHECK(actions_of(world, 'M', 0).empty());  // held: the application's
}

TEST_CASE("a full stop selects the nearest node, and where that is selected its internode")
{
    World world;
    trace_three(world);
    const SelectOp again = only_trace<SelectOp>(actions_of(world, '.', 0));
    CHECK(again.is_internode);
    CHECK_FALSE(again.within_voxels);
    world.model.probe_voxel = {12.0, 10.0, 10.0};
    const SelectOp other = only_trace<SelectOp>(actions_of(world, '.', 0));
    CHECK_FALSE(other.is_internode);
    CHECK(other.within_voxels == 16.0);
    world.trace.select({});
    CHECK_FALSE(only_trace<SelectOp>(actions_of(world, '.', 0)).is_internode);
}

TEST_CASE("equals and minus change what is selected, or the internodes of the group; with Alt its nodes")
{
    World world;
    trace_three(world);
    const RadiusOp larger = only_trace<RadiusOp>(actions_of(world, '=', 0));
    CHECK((larger.of == RadiusOp::Of::selected));
    CHECK(larger.radius_voxels.value() == doctest::Approx(2.2));
    CHECK(only_trace<RadiusOp>(actions_of(world, '-', 0)).radius_voxels.value() == doctest::Approx(2.0 / 1.1));
    CHECK(only_trace<RadiusOp>(actions_of(world, '=', SHIFT)).radius_voxels.value() ==
          doctest::Approx(2.0 * std::pow(1.1, 0.2)));
    world.trace.select({});
    const RadiusOp internodes = only_trace<RadiusOp>(actions_of(world, '=', 0));
    CHECK((internodes.of == RadiusOp::Of::internodes));
    CHECK(internodes.group == 2);
    CHECK(internodes.radius_voxels.value() == doctest::Approx(2.2));
    const RadiusOp nodes = only_trace<RadiusOp>(actions_of(world, '=', ALT));
    CHECK((nodes.of == RadiusOp::Of::nodes));
    CHECK(nodes.group == 2);
}

TEST_CASE("X changes between painting and tracing")
{
    World world;
    CHECK((only<SetTool>(actions_of(world, 'X', 0)).tool == Tool::trace));
    world.model.tool = Tool::trace;
    CHECK((only<SetTool>(actions_of(world, 'X', 0)).tool == Tool::paint));
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
