// Operations on a trace, as scripts and the window use them: voxels are converted to the volume's unit, distant targets
// are refused, and exactly the affected parts change.

#include "engine/annotation/trace/trace_command.h"

#include <algorithm>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/trace/trace_segments.h"
#include "engine/base/error.h"
#include "tests/support/random_annotation.h"
#include "tests/support/tracing.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

SelectOp nearest(const glm::dvec3& voxel, std::optional<double> within = {})
{
    return {.near = voxel, .number = {}, .is_internode = false, .within_voxels = within};
}

std::string refusal(const Tracing& work, const TraceOp& op)
{
    return test::error_of([&] { static_cast<void>(work.effect(op)); });
}

}  // namespace

TEST_CASE("a node stands at its voxel, in the volume's unit, with the probe's size and group where none is given")
{
    Tracing work;
    work.perform(work.node_at({10, 10, 10}));
    CHECK(work.trace().node(0) == TraceNode{{20, 30, 40}, 10.0, 7});
    work.perform(NodeOp{.at = {11, 10, 10}, .radius_voxels = 1.5, .group = 3});
    CHECK(work.trace().node(1) == TraceNode{{22, 30, 40}, 3.0, 3});
    CHECK(work.trace().internode_between(0, 1));
    CHECK(work.effect(work.node_at({0, 0, 0})).label == "added a node in group 7");
}

TEST_CASE(
    "a node divides an internode, is as wide and of the group that it has there, and takes the selected node's link")
{
    Tracing work;
    work.perform(NodeOp{.at = {10, 10, 10}, .radius_voxels = 1.0, .group = 3});
    work.perform(NodeOp{.at = {20, 10, 10}, .radius_voxels = 3.0, .group = 3});
    work.perform(DeselectOp{});
    work.perform(NodeOp{.at = {15, 20, 10}, .radius_voxels = 2.0, .group = 4});
    const TraceGraph before = work.trace();
    const NodeOp dividing{.at = {15, 10, 10}, .radius_voxels = {}, .group = {}, .divides = 0};
    CHECK(work.effect(dividing).label == "added a node in internode 0");
    work.perform(dividing);
    const TraceGraph& trace = work.trace();
    CHECK(trace.node(3) == TraceNode{{30, 30, 40}, 4.0, 3});
    CHECK(trace.selection() == TraceSelection{{3}, {}});
    CHECK(!trace.internodes().contains(0));
    const auto group_between = [&](uint32_t a, uint32_t b) {
        const auto number = trace.internode_between(a, b);
        return number ? int(trace.internode(*number).group) : 0;
    };
    CHECK(group_between(0, 3) == 3);
    CHECK(group_between(3, 1) == 3);
    CHECK(group_between(2, 3) == 4);
    CHECK(trace.internodes().size() == 3);
    CHECK(segments_of(trace).size() == 3);
    // One step, undone as it was.
    work.history.undo(work.document);
    CHECK(work.trace() == before);
    CHECK(work.trace().selection() == TraceSelection{{2}, {}});
    // From an end of the internode there is nothing more to link.
    work.perform(SelectOp{.near = {}, .number = 1, .within_voxels = {}});
    NodeOp own = dividing;
    own.radius_voxels = 1.5;
    own.group = 9;
    work.perform(own);
    const uint32_t added = *work.trace().selection().node();
    CHECK(work.trace().node(added) == TraceNode{{30, 30, 40}, 3.0, 9});
    CHECK(work.trace().internodes_of(added).size() == 2);
    CHECK(refusal(work, dividing) == "internode 0 does not exist; expected one of the trace");
    own.at = {90, 10, 10};
    own.divides = work.trace().internodes_of(added)[0];
    TraceDefaults in_volume = TRACE_DEFAULTS;
    in_volume.size = Size3(64);
    const std::string why = test::error_of([&] { static_cast<void>(effect_of(own, work.trace(), in_volume)); });
    CHECK(why.find("outside the volume") != std::string::npos);
}

TEST_CASE(
    "the nearest place on a trace is that of a search one by one, through edits, and no internode is longer than said")
{
    std::mt19937 random(47);
    std::uniform_real_distribution<double> place(0.0, 60.0), lot(0.0, 1.0);
    Tracing work;
    const auto voxel = [&] { return glm::dvec3(place(random), place(random), place(random)); };
    int found = 0, none = 0;
    for (int step = 0; step < 400; ++step) {
        const double what = lot(random);
        if (what < 0.6 || work.trace().nodes().size() < 4)
            work.perform(work.node_at(lot(random) < 0.05 ? voxel() : 0.2 * voxel()));
        else if (what < 0.75)
            work.perform(nearest(voxel()));
        else if (what < 0.85 && work.trace().selection().node())
            work.perform(MoveOp{voxel()});
        else if (what < 0.9 && !work.trace().selection().empty())
            work.perform(DeleteOp{});
        else if (work.history.undoable() > 0)
            work.history.undo(work.document);
        const TraceGraph& trace = work.trace();
        double longest = 0.0;
        for (const auto& [number, internode] : trace.internodes())
            longest = std::max(longest, trace.length_of(internode));
        CHECK(longest <= trace.longest_at_most());
        CHECK(longest * 2.0 >= trace.longest_at_most());
        const glm::dvec3 point = voxel() * TRACE_DEFAULTS.spacing;
        const double reach = 40.0 * lot(random);
        const auto except = trace.selection().node();
        std::optional<uint32_t> best;
        double least = reach;
        for (const auto& [number, internode] : trace.internodes()) {
            if (except && (internode.a == *except || internode.b == *except)) continue;
            const double away = distance_to(trace, internode, point);
            if (away < least) best = number, least = away;
        }
        const auto there = nearest_place(trace, point, reach, except);
        REQUIRE(there.has_value() == best.has_value());
        ++(there ? found : none);
        if (!there) continue;
        CHECK(glm::distance(there->position, point) == doctest::Approx(least).epsilon(1e-12));
        CHECK(distance_to(trace, trace.internode(there->internode), there->position) < 1e-9);
        CHECK(there->share == share_along(trace, trace.internode(there->internode), point));
    }
    CHECK(found > 50);
    CHECK(none > 50);
}

TEST_CASE("selecting is no step of the history, and what is too far away is not taken")
{
    Tracing work;
    for (const double x : {10.0, 20.0, 40.0}) work.perform(work.node_at({x, 10, 10}));
    const size_t steps = work.history.undoable();
    CHECK(work.effect(nearest({19, 10, 10})).changes.empty());
    work.perform(nearest({19, 10, 10}));
    CHECK(work.trace().selection() == TraceSelection{{1}, {}});
    CHECK(work.history.undoable() == steps);
    CHECK(refusal(work, nearest({30, 10, 10}, 5.0)) == "the nearest node is 10 voxels away; expected one within 5");
    CHECK(refusal(work, LinkOp{.near = glm::dvec3(60, 10, 10), .node = {}, .within_voxels = 12.0}) ==
          "the nearest other node is 20 voxels away; expected one within 12");
    work.perform(SelectOp{.near = glm::dvec3(31, 10, 10), .number = {}, .is_internode = true, .within_voxels = {}});
    CHECK(work.trace().selection() == TraceSelection{{}, {1}});
    work.perform(SelectSegmentOp{});
    CHECK(work.trace().selection() == TraceSelection{{0, 1, 2}, {0, 1}});
    work.perform(DeselectOp{});
    CHECK(work.trace().selection().empty());
    CHECK(refusal(work, SelectOp{.near = {}, .number = 9, .is_internode = false, .within_voxels = {}}) ==
          "node 9 does not exist; expected one of the trace");
    CHECK(refusal(work, DeleteOp{}) == "nothing is selected; expected a node, an internode or a segment");
}

namespace {

std::map<uint32_t, TraceNode> nodes_of(const TraceGraph& trace)
{
    std::map<uint32_t, TraceNode> nodes;
    for (const auto& [number, node] : trace.nodes()) nodes[number] = node;
    return nodes;
}

}  // namespace

// Kind (Touch): a segment that is moved
TEST_CASE("a selected segment moves as a whole in one step, is undone exactly, and stays where it may not go")
{
    Tracing work;
    // The branch at node 1 belongs to three segments, and stays.
    for (const double x : {10.0, 20.0, 30.0, 40.0}) work.perform(work.node_at({x, 10, 10}));
    work.perform(SelectOp{.near = {}, .number = 1, .within_voxels = {}});
    work.perform(work.node_at({20, 20, 10}));
    work.perform(SelectOp{.near = {}, .number = 2, .is_internode = true, .within_voxels = {}});
    work.perform(SelectSegmentOp{});
    const TraceSelection segment = work.trace().selection();
    REQUIRE(segment.nodes == std::vector<uint32_t>{2, 3});
    const TraceGraph before = work.trace();
    const glm::dvec3 by(1, -2, 3);
    const size_t steps = work.history.undoable();
    work.perform(MoveOp{.to = glm::dvec3(5, 5, 5) + by, .from = glm::dvec3(5, 5, 5)});
    CHECK(work.history.undoable() == steps + 1);
    const TraceGraph after = work.trace();
    for (const auto& [number, node] : before.nodes()) {
        const bool is_moved = number == 2 || number == 3;
        const glm::dvec3 expected = node.position + (is_moved ? by * TRACE_DEFAULTS.spacing : glm::dvec3(0.0));
        CHECK(glm::distance(after.node(number).position, expected) < 1e-12);
        CHECK(after.node(number).radius == node.radius);
    }
    CHECK(after.internodes().size() == before.internodes().size());
    CHECK(after.selection() == segment);
    CHECK(work.history.undo(work.document) != nullptr);
    CHECK(nodes_of(work.trace()) == nodes_of(before));
    CHECK(work.history.redo(work.document) != nullptr);
    CHECK(nodes_of(work.trace()) == nodes_of(after));
    // The ends of a lone internode move with it.
    work.perform(SelectOp{.near = {}, .number = 0, .is_internode = true, .within_voxels = {}});
    work.perform(MoveOp{.to = glm::dvec3(0, 1, 0), .from = glm::dvec3(0.0)});
    CHECK(work.trace().node(0).position.y == doctest::Approx(11.0 * TRACE_DEFAULTS.spacing.y));
    CHECK(work.trace().node(1).position.y == doctest::Approx(11.0 * TRACE_DEFAULTS.spacing.y));
    // No part of it is moved where one node would be outside.
    const TraceGraph last = work.trace();
    TraceDefaults inside = TRACE_DEFAULTS;
    inside.size = Size3(64);
    CHECK_THROWS_AS(effect_of(MoveOp{.to = glm::dvec3(-30, 0, 0), .from = glm::dvec3(0.0)}, last, inside), Error);
    CHECK(effect_of(MoveOp{.to = glm::dvec3(-5, 0, 0), .from = glm::dvec3(0.0)}, last, inside).changes.size() == 2);
    work.perform(DeselectOp{});
    CHECK(refusal(work, MoveOp{.to = glm::dvec3(1.0), .from = glm::dvec3(0.0)}) ==
          "nothing is selected; expected a node, an internode or a segment");
}

TEST_CASE("link, move, size, group and delete are one step each, and undone they leave what was")
{
    Tracing work;
    for (const double x : {10.0, 20.0, 30.0}) work.perform(work.node_at({x, 10, 10}));
    const TraceOp edits[] = {LinkOp{.near = glm::dvec3(9, 10, 10), .node = {}, .within_voxels = 5.0},
                             MoveOp{{31, 12, 10}},
                             GroupOp{2},
                             RadiusOp{.radius_voxels = 2.0},
                             RadiusOp{.of = RadiusOp::Of::nodes, .radius_voxels = 3.0, .group = 7},
                             RadiusOp{.of = RadiusOp::Of::internodes, .radius_voxels = 1.0, .group = 7},
                             DeleteOp{}};
    for (const TraceOp& op : edits) {
        const size_t steps = work.history.undoable();
        work.perform(op);
        CHECK(work.history.undoable() == steps + 1);
    }
    CHECK(work.trace().nodes().size() == 2);
    CHECK(work.trace().internodes().size() == 1);
    CHECK(work.trace().node(0).radius == 6.0);
    CHECK(work.trace().internode_radii().at(7) == 2.0);
    for (size_t i = 0; i < std::size(edits); ++i) CHECK(work.history.undo(work.document) != nullptr);
    CHECK(work.trace().nodes().size() == 3);
    CHECK(work.trace().node(2) == TraceNode{{60, 30, 40}, 10.0, 7});
    CHECK_FALSE(work.trace().internode_between(2, 0));
}

TEST_CASE("a summary counts segments and adds lengths up by group")
{
    Tracing work;
    for (const double x : {10.0, 20.0, 30.0}) work.perform(work.node_at({x, 10, 10}));
    work.perform(nearest({20, 10, 10}));
    work.perform(NodeOp{.at = {20, 20, 10}, .radius_voxels = 1.0, .group = 2});
    const TraceSummary summary = work.trace().summary();
    CHECK(summary.nodes == 4);
    CHECK(summary.internodes == 3);
    CHECK(summary.segments == 3);
    CHECK(summary.length == doctest::Approx(70.0));
    CHECK(summary.group_length.at(7) == doctest::Approx(40.0));
    CHECK(summary.group_length.at(2) == doctest::Approx(30.0));
}

TEST_CASE("a summary of any trace has the segments that there are")
{
    std::mt19937 random(91);  // seed 91
    const auto below = [&](uint32_t end) { return uint32_t(random() % end); };
    size_t most_loops = 0;
    for (int trial = 0; trial < 300; ++trial) {
        CAPTURE(trial);
        TraceGraph trace;
        const uint32_t nodes = 1 + below(14), links = below(nodes + 4);
        std::vector<uint32_t> numbers;
        for (uint32_t i = 0, number = below(5); i < nodes; ++i, number += 1 + below(trial % 2 ? 1 : 3)) {
            const TraceNode node{.position = {below(50), below(50), below(50)}, .radius = 1.0};
            trace.apply(TraceNodeChange{number, {}, node}, Direction::forwards);
            numbers.push_back(number);
        }
        uint32_t next = 0;
        const auto link = [&](uint32_t a, uint32_t b) {
            if (a == b || trace.internode_between(a, b)) return;
            trace.apply(TraceInternodeChange{next++, {}, TraceInternode{a, b, uint8_t(1 + below(3))}},
                        Direction::forwards);
        };
        for (size_t i = 2; i < nodes && trial % 3 == 0; i += 3) {  // triangles
            link(numbers[i], numbers[i - 1]);
            link(numbers[i - 1], numbers[i - 2]);
            link(numbers[i - 2], numbers[i]);
        }
        for (uint32_t i = below(links + 1); i < links; ++i) link(numbers[below(nodes)], numbers[below(nodes)]);
        const std::vector<TraceSegment> segments = segments_of(trace);
        const TraceSummary summary = trace.summary();
        CHECK(summary.segments == segments.size());
        double length = 0.0;
        for (const auto& [number, internode] : trace.internodes()) length += trace.length_of(internode);
        CHECK(summary.length == doctest::Approx(length).epsilon(1e-12));
        size_t loops = 0;
        for (const TraceSegment& segment : segments)
            loops += segment.is_loop() && trace.internodes_of(segment.nodes.front()).size() == 2;
        most_loops = std::max(most_loops, loops);
    }
    CHECK(most_loops > 1);
}

TEST_CASE("a summary kept through random commands, undone and redone, is that of the trace as it is")
{
    std::mt19937 random(17);  // seed 17
    size_t most_loops = 0;
    for (int trial = 0; trial < 30; ++trial) {
        CAPTURE(trial);
        Document document = test::unannotated();
        History history;
        for (int step = 0; step < 200; ++step) {
            CAPTURE(step);
            if (random() % 4 > 0)
                history.perform(document, test::random_tracing(document, random));
            else if (random() % 3 > 0)
                history.undo(document);
            else
                history.redo(document);
            const TraceGraph& trace = document.trace;
            const TraceSummary summary = trace.summary();
            REQUIRE(summary.nodes == trace.nodes().size());
            REQUIRE(summary.internodes == trace.internodes().size());
            const std::vector<TraceSegment> segments = segments_of(trace);
            REQUIRE(summary.segments == segments.size());
            double length = 0.0;
            std::map<uint8_t, double> by_group;
            for (const auto& [number, internode] : trace.internodes()) {
                length += trace.length_of(internode);
                by_group[internode.group] += trace.length_of(internode);
            }
            REQUIRE(summary.length == doctest::Approx(length).epsilon(1e-12));
            REQUIRE(summary.group_length.size() == by_group.size());
            for (const auto& [group, of_group] : by_group)
                REQUIRE(summary.group_length.at(group) == doctest::Approx(of_group).epsilon(1e-12));
            const auto loops = size_t(std::ranges::count_if(segments, [&](const TraceSegment& segment) {
                return segment.is_loop() && trace.internodes_of(segment.nodes.front()).size() == 2;
            }));
            most_loops = std::max(most_loops, loops);
        }
    }
    CHECK(most_loops > 0);
}

TEST_CASE("what is added far away and taken back leaves no trace in a length")
{
    Tracing work;
    for (const double x : {10.0, 10.1, 30.7}) work.perform(work.node_at({x, 10, 10}));
    const TraceSummary before = work.trace().summary();
    work.perform(work.node_at({1e11, 10, 10}));
    CHECK(work.trace().summary().length > 1e11);
    work.history.undo(work.document);
    CHECK(work.trace().summary().length == before.length);
    CHECK(work.trace().summary().group_length == before.group_length);
}

TEST_CASE("a node may lie outside the volume by its radius and a voxel, and is refused beyond")
{
    Tracing work;
    const auto said = [&](const TraceOp& op) {
        TraceDefaults defaults = TRACE_DEFAULTS;
        defaults.size = {10, 20, 30};
        return error_of([&] { static_cast<void>(effect_of(op, work.trace(), defaults)); });
    };
    // Spacing 2, 3, 4; the probe's radius is 5 voxels of 2, and the longest side of a voxel 4.
    for (const glm::dvec3& inside :
         {glm::dvec3{0, 0, 0}, {10, 20, 30}, {-7, 10, 10}, {17, 10, 10}, {5, -4.6, 10}, {5, 10, 33.5}})
        CHECK(said(work.node_at(inside)) == "");
    for (const glm::dvec3& outside :
         {glm::dvec3{-7.1, 10, 10}, {17.1, 10, 10}, {5, -4.7, 10}, {5, 10, 33.6}, {-6, -4, 10}, {1e300, 0, 0}})
        CHECK(said(work.node_at(outside)).find("voxel widths outside the volume of 10 x 20 x 30 voxels") !=
              std::string::npos);
    CHECK(said(work.node_at({-9, 10, 10})) ==
          "the node at -9 10 10 is 9 voxel widths outside the volume of 10 x 20 x 30 voxels; expected at most 7, its "
          "radius and the longest side of a voxel");
    NodeOp thin = work.node_at({-3, 0, 0});
    thin.radius_voxels = 0.5;
    CHECK(said(thin) != "");
    work.perform(work.node_at({5, 10, 10}));
    CHECK(said(MoveOp{{-7, 10, 10}}) == "");
    CHECK(said(MoveOp{{-7.1, 10, 10}}) != "");
    // Without a volume, nodes may lie anywhere.
    work.perform(work.node_at({1e6, 0, 0}));
}
