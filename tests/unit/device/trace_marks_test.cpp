// Parts of a trace that are marked, and boxes that are drawn again after an operation.

#include "engine/live/trace_marks.h"

#include <doctest/doctest.h>

#include "engine/device/trace_surfaces.h"
#include "tests/support/tracing.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("what is drawn again holds what was there and what is there")
{
    Tracing work;
    for (const double x : {10.0, 20.0, 30.0}) work.perform(work.node_at({x, 10, 10}));
    const auto reach_of_last = [&](const TraceOp& op) {
        const TraceEffect made = work.effect(op);
        const std::vector<Change> changes(made.changes.begin(), made.changes.end());
        work.perform(op);
        return trace_reach(work.trace(), changes, TRACE_DEFAULTS.spacing);
    };
    const auto holds = [](const VoxelBox& box, const glm::dvec3& voxel) {
        return glm::all(glm::lessThanEqual(glm::dvec3(box.lower), voxel)) &&
               glm::all(glm::greaterThanEqual(glm::dvec3(box.upper), voxel));
    };
    // Node 2 goes away from node 1, and the rod between them with it. Its radius is 5 voxels along x.
    const VoxelBox moved = reach_of_last(MoveOp{{30, 40, 10}});
    for (const glm::dvec3& voxel : {glm::dvec3(35, 10, 10), glm::dvec3(30, 43, 10), glm::dvec3(15, 10, 10)})
        CHECK(holds(moved, voxel));
    CHECK_FALSE(holds(moved, {8, 10, 10}));
    const VoxelBox deleted = reach_of_last(DeleteOp{});
    for (const glm::dvec3& voxel : {glm::dvec3(30, 43, 10), glm::dvec3(20, 10, 10)}) CHECK(holds(deleted, voxel));
    CHECK(trace_reach(work.trace(), {}, TRACE_DEFAULTS.spacing) == VoxelBox{});
}

TEST_CASE("the selected node is marked yellow where it is or where it is dragged, and the nearby one purple")
{
    Tracing work;
    for (const double x : {10.0, 20.0, 30.0}) work.perform(work.node_at({x, 10, 10}));
    const TraceMarks marks = trace_marks(work.trace(), 0, 1.0);
    REQUIRE(marks.balls.size() == 2);
    CHECK(marks.balls[0].color == NEARBY_COLOR);
    CHECK(marks.balls[0].center == work.trace().node(0).position);
    CHECK(marks.balls[1].color == SELECTED_COLOR);
    CHECK(marks.balls[1].center == work.trace().node(2).position);
    CHECK(marks.lines.empty());
    const glm::dvec3 by(1, 2, 3);
    const TraceMarks dragged = trace_marks(work.trace(), std::nullopt, 1.0, by);
    REQUIRE(dragged.balls.size() == 1);
    CHECK(dragged.balls[0].center == work.trace().node(2).position + by);
    REQUIRE(dragged.lines.size() == 1);
    CHECK(dragged.lines[0].from == work.trace().node(1).position);
    CHECK(dragged.lines[0].to == work.trace().node(2).position + by);
    work.perform(SelectSegmentOp{});
    CHECK(trace_marks(work.trace(), std::nullopt, 1.0).lines.size() == 2);
    // A segment is dragged as a whole.
    const TraceMarks segment = trace_marks(work.trace(), std::nullopt, 1.0, by);
    REQUIRE(segment.balls.size() == 3);
    CHECK(segment.balls[0].center == work.trace().node(0).position + by);
    REQUIRE(segment.lines.size() == 2);
    CHECK(segment.lines[1].to == work.trace().node(2).position + by);
}

TEST_CASE("internodes about the selected node are lines over the picture, nearest first, where that is wanted")
{
    Tracing work;
    for (const double x : {10.0, 20.0, 30.0, 40.0}) work.perform(work.node_at({x, 10, 10}));
    const auto lines = [&](size_t most) { return trace_marks(work.trace(), std::nullopt, 1.0, {}, most).lines; };
    CHECK(lines(0).empty());
    REQUIRE(lines(64).size() == 3);
    for (const OverlayScene::Line& line : lines(64)) CHECK(line.color == LINKED_COLOR);
    REQUIRE(lines(1).size() == 1);
    CHECK(lines(1)[0].from == work.trace().node(2).position);
    CHECK(lines(1)[0].to == work.trace().node(3).position);
    work.perform(DeselectOp{});
    CHECK(lines(64).empty());
}
