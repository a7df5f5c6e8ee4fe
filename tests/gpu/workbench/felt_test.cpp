// What is seen is what is felt, at the workbench; and segments of a trace that follow the probe.

#include <chrono>
#include <cmath>
#include <map>
#include <thread>

#include <doctest/doctest.h>

#include "engine/workbench/edits/trace_ops.h"
#include "haptics/replay/replay.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

template <class Condition>
bool advance_until(Workbench& bench, const Condition& condition)
{
    for (int turn = 0; turn < 5000; ++turn) {
        bench.advance();
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

std::map<uint32_t, TraceNode> nodes_of(const TraceGraph& trace)
{
    std::map<uint32_t, TraceNode> nodes;
    for (const auto& [number, node] : trace.nodes()) nodes[number] = node;
    return nodes;
}

Action toggled_hidden(const Workbench& bench)
{
    return shortcut_named("feels_hidden")->action(bench.model(), 1.0);
}

/// A stylus path past a tube of the tubes scan, in that scan's units; the button is down from the 1200th tick on.
Trace path_past_a_tube()
{
    constexpr double VOXEL_M = 0.00025, LENGTH = 24.0;
    constexpr size_t TICKS = 3000;
    Trace trace;
    trace.unit = "voxel";
    trace.caps.outputs_force = true;
    TraceSettings settings;
    settings.force.workspace = {glm::dmat3(1.0 / VOXEL_M), {8.0, 18.0, 16.0}};
    trace.settings.push_back(settings);
    for (size_t i = 0; i < TICKS; ++i) {
        TraceTick tick;
        tick.now_ns = 1'000'000 * (i + 1);
        tick.state.time_ns = tick.now_ns;
        tick.state.sequence = uint32_t(i + 1);
        tick.state.position_m = {LENGTH * VOXEL_M * double(i) / double(TICKS), 0.0, 0.0};
        tick.state.buttons = i > 1200 ? PAINT_BUTTON : 0;
        trace.ticks.push_back(tick);
    }
    return trace;
}

}  // namespace

// Kind (Touch): guidance where the picture shows nothing
TEST_CASE_FIXTURE(OnDevice, "what is seen is what is felt: no cut, clip plane, hidden group or transparent intensity")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(Set{R"({"probe":{"guided":true}})"});
    const auto step = [&]() -> const ForceStep& { return bench.document().touch.last_state().step; };
    const auto is_felt = [&] { return advance_until(bench, [&] { return step().in_contact; }); };
    const auto is_not_felt = [&] {
        return advance_until(bench, [&] { return !step().in_contact && !(step().flags & FORCE_NO_REGION); });
    };
    REQUIRE(is_felt());
    const std::pair<const char*, const char*> ways[] = {
        {R"({"cut":{"upper":[5,36,32]}})", R"({"cut":{"upper":[40,36,32]}})"},
        {R"({"unpainted":{"visible":false}})", R"({"unpainted":{"visible":true}})"},
        {R"({"unpainted":{"opacity":0}})", R"({"unpainted":{"opacity":1}})"},
        {R"({"view":{"solo":9}})", R"({"view":{"solo":null}})"}};
    for (const auto& [hides, shows] : ways) {
        CAPTURE(hides);
        bench.perform(Set{hides});
        REQUIRE(is_not_felt());
        bench.perform(toggled_hidden(bench));
        CHECK(bench.messages().last() == "What is cut away, hidden or transparent is felt, too");
        REQUIRE(is_felt());
        bench.perform(toggled_hidden(bench));
        CHECK(bench.messages().last() == "Only what the picture shows is felt");
        REQUIRE(is_not_felt());
        bench.perform(Set{shows});
        REQUIRE(is_felt());
    }
    const Camera camera = bench.document().camera;
    bench.perform(read_action(R"({"op":"move_clip","share":3})", "row"));
    REQUIRE(bench.document().camera.near_distance > camera.near_distance);
    REQUIRE(is_not_felt());
    bench.perform(read_action(R"({"op":"move_clip","share":-3})", "row"));
    REQUIRE(is_felt());
    // A transfer function that shows only what is brighter than anything here.
    const double highest = bench.model().statistics.maximum;
    const auto point = [](double intensity, double opacity) {
        return sentence(R"({"intensity":)", intensity, R"(,"opacity":)", opacity, "}");
    };
    bench.perform(Set{
        sentence(R"({"transfer_function":{"points":[)", point(highest - 1.0, 0.0), ",", point(highest, 0.0), "]}}")});
    REQUIRE(is_not_felt());
    // Paint is seen whatever its intensity, until its group is hidden.
    bench.perform(
        read_action(R"({"op":"paint","brush":"fill","group":3,"threshold":0,"radius":8,"path":[[20,18,16]]})", "row"));
    REQUIRE(is_felt());
    bench.perform(Set{R"({"groups":{"3":{"visible":false}}})"});
    REQUIRE(is_not_felt());
}

// Kind (Touch): a guided probe that rests against a surface
TEST_CASE_FIXTURE(OnDevice, "a guided probe comes to rest, although the servo may oscillate in the last bits")
{
    constexpr uint64_t RESTS_FOR = 100;  // ticks
    TemporaryFolder folder;
    Workbench bench(renderer(), {});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(Set{R"({"probe":{"guided":true}})"});
    const Touch& touch = bench.document().touch;
    for (int place = 0; place < 12; ++place) {
        bench.perform(PlaceProbe{{8.3 + 1.7 * place, 18.1 + 0.3 * place, 16.2}});
        glm::dvec3 seen = touch.probe();
        uint64_t since = touch.last_state().ticks;
        CHECK(advance_until(bench, [&] {
            const uint64_t ticks = touch.last_state().ticks;
            if (touch.probe() != seen || ticks < since) seen = touch.probe(), since = ticks;
            return ticks - since > RESTS_FOR && touch.last_state().relevance_time_ns > 0;
        }));
    }
}

TEST_CASE_FIXTURE(OnDevice, "a recorded stylus feels what is seen, and an older recording what was felt then")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_tubes_session(folder.path), {});
    Trace path = path_past_a_tube();
    write_trace(folder.path / "older.trace", path);
    path.feels_seen = true;
    write_trace(folder.path / "seen.trace", path);
    bench.perform(Set{R"({"cut":{"upper":[1,1,1]},"probe":{"tool":"trace","radius_voxels":5,"guided":true,)"
                      R"("touch":{"at_proxy":true,"mode":"object"}}})"});
    const TraceGraph& trace = bench.document().annotator.document().trace;
    const auto stray = [&](const char* name) {
        const size_t before = trace.nodes().size();
        bench.perform(DeselectOp{});
        bench.perform(FollowStylus{folder.path / name});
        settle(bench);
        CHECK(trace.nodes().size() > before);
        double most = 0.0;
        for (const auto& [number, node] : trace.nodes())
            if (number >= before) most = std::max(most, std::hypot(node.position.y - 18.0, node.position.z - 16.0));
        return most;
    };
    CHECK(stray("seen.trace") < 0.01);
    CHECK(stray("older.trace") > 0.2);
    bench.perform(Set{R"({"probe":{"touch":{"feels_hidden":true}}})"});
    CHECK(stray("seen.trace") > 0.2);
}

// Kind (Touch): tools at nodes that are not drawn
TEST_CASE_FIXTURE(OnDevice, "nodes of hidden groups draw no tool, unless hidden parts are felt")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_tubes_session(folder.path), {});
    bench.perform(NodeOp{.at = {10.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(NodeOp{.at = {20.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
    bench.perform(DeselectOp{});
    bench.perform(Set{R"({"probe":{"radius_voxels":4,"touch":{"to_nodes":true,"to_lines":true}}})"});
    bench.perform(PlaceProbe{{11.5, 12.0, 15.0}});
    CHECK(bench.model().tool_node == 0u);
    bench.perform(Set{R"({"groups":{"2":{"visible":false}}})"});
    CHECK(!bench.model().tool_node);
    CHECK(!bench.model().tool_internode);
    bench.perform(Set{R"({"probe":{"touch":{"feels_hidden":true}}})"});
    CHECK(bench.model().tool_node == 0u);
    bench.perform(Set{R"({"groups":{"2":{"visible":true}},"probe":{"touch":{"feels_hidden":false}}})"});
    CHECK(bench.model().tool_node == 0u);
    bench.perform(Set{R"({"view":{"meshes":false}})"});
    CHECK(!bench.model().tool_node);
}

// Kind (Touch): selecting and linking the nearest of nodes that are not drawn
TEST_CASE_FIXTURE(OnDevice, "nodes of hidden groups are neither selected nor linked, unless hidden parts are felt")
{
    TemporaryFolder folder;
    Workbench bench(renderer(), {.has_servo = false});
    bench.open(write_tubes_session(folder.path), {});
    const auto add = [&](double x, uint8_t group) {
        bench.perform(DeselectOp{});
        bench.perform(NodeOp{.at = {x, 12.0, 14.0}, .radius_voxels = {}, .group = group});
    };
    add(10.0, 2);
    add(13.0, 3);
    add(17.0, 4);
    bench.perform(DeselectOp{});
    bench.perform(Set{R"({"probe":{"radius_voxels":6}})"});
    bench.perform(PlaceProbe{{10.5, 12.0, 14.0}});
    const TraceGraph& trace = bench.document().annotator.document().trace;
    const auto press = [&](const char* id) { bench.perform(shortcut_named(id)->action(bench.model(), 1.0)); };
    press("select_nearest");
    CHECK(trace.selection().node() == 0u);
    bench.perform(DeselectOp{});
    bench.perform(Set{R"({"groups":{"2":{"visible":false}}})"});
    CHECK(bench.model().nearby_node == 1u);
    press("select_nearest");
    CHECK(trace.selection().node() == 1u);
    press("link_nearest");
    CHECK(trace.internode_between(1, 2));
    CHECK(!trace.internode_between(0, 1));
    bench.perform(DeselectOp{});
    bench.perform(Set{R"({"view":{"solo":9}})"});
    CHECK(!bench.model().nearby_node);
    CHECK(
        contains(error_of([&] { press("select_nearest"); }), "all nodes of the trace are in hidden groups; expected"));
    bench.perform(Set{R"({"probe":{"touch":{"feels_hidden":true}}})"});
    press("select_nearest");
    CHECK(trace.selection().node() == 0u);
}

// Kind (Touch): a segment that is dragged
TEST_CASE_FIXTURE(OnDevice, "a selected segment follows the probe, or moves to it, and is replayed from the journal")
{
    TemporaryFolder folder;
    const std::filesystem::path session = write_tubes_session(folder.path);
    std::map<uint32_t, TraceNode> moved;
    {
        Workbench bench(renderer(), {.has_servo = false});
        bench.open(session, {});
        bench.perform(NodeOp{.at = {10.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
        bench.perform(NodeOp{.at = {20.0, 12.0, 14.0}, .radius_voxels = {}, .group = 2});
        bench.perform(PlaceProbe{{15.0, 15.0, 15.0}});
        bench.perform(DeselectOp{});
        CHECK(bench.why_not(DragNode{true}) == "nothing is selected");
        bench.perform(SelectOp{.near = {}, .number = 0, .is_internode = true, .within_voxels = {}});
        bench.perform(SelectSegmentOp{});
        const TraceGraph& trace = bench.document().annotator.document().trace;
        const glm::dvec3 first = trace.node(0).position, second = trace.node(1).position;
        const size_t steps = bench.model().undoable;
        bench.perform(DragNode{true});
        bench.perform(PlaceProbe{{16.0, 17.0, 14.0}});
        bench.perform(DragNode{false});
        CHECK(bench.model().undoable == steps + 1);
        CHECK(trace.node(0).position == first + glm::dvec3(1.0, 2.0, -1.0));
        CHECK(trace.node(1).position == second + glm::dvec3(1.0, 2.0, -1.0));
        bench.perform(UndoOp{1});
        CHECK(trace.node(1).position == second);
        bench.perform(RedoOp{1});
        // The nearest node goes to the probe, and the rest with it.
        bench.perform(PlaceProbe{{24.0, 14.0, 13.0}});
        bench.perform(move_to_probe(bench.model()));
        CHECK(trace.node(1).position == glm::dvec3(24.0, 14.0, 13.0));
        CHECK(trace.node(0).position == glm::dvec3(14.0, 14.0, 13.0));
        moved = nodes_of(trace);
        settle(bench);
    }
    Workbench again(renderer(), {.has_servo = false});
    again.open(session, {});
    const TraceGraph& trace = again.document().annotator.document().trace;
    CHECK(nodes_of(trace) == moved);
    again.perform(UndoOp{1});
    CHECK(trace.node(1).position == glm::dvec3(21.0, 14.0, 13.0));
}
