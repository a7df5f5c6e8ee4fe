// A trace as balls and rods.

#include "engine/device/trace_surfaces.h"

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("nodes are balls and internodes rods, of their own colours, and nodes are the thicker ones")
{
    TraceGraph trace;
    const auto add = [&](uint32_t number, const TraceNode& node) {
        trace.apply(TraceNodeChange{number, std::nullopt, node}, Direction::forwards);
    };
    add(0, {.position = {1, 2, 3}, .radius = 0.5, .group = 1});
    add(1, {.position = {4, 6, 3}, .radius = 0.0, .group = 2});
    add(2, {.position = {9, 9, 9}, .radius = 2.0, .group = 3});
    trace.apply(TraceInternodeChange{0, std::nullopt, TraceInternode{0, 1, 1}}, Direction::forwards);
    trace.apply(TraceInternodeChange{1, std::nullopt, TraceInternode{1, 2, 3}}, Direction::forwards);
    Groups groups;
    groups[1] = {.color = glm::dvec3(1.0, 0.0, 0.0)};
    groups[2] = {.parent = 1};
    groups[3] = {.visible = false};
    const std::vector<KeyedSurface> surfaces = surfaces_of(trace, groups, {0.4, 0.5, 2.0});
    REQUIRE(surfaces.size() == 3);  // nothing of group 3
    const glm::dvec3 red(1.0, 0.0, 0.0);
    CHECK((surfaces[0].look == SurfaceLook{{1, 2, 3}, {1, 2, 3}, NODE_FACTOR * 0.5, NODE_FACTOR * 0.5, red}));
    CHECK((surfaces[1].look == SurfaceLook{{4, 6, 3},
                                           {4, 6, 3},
                                           NODE_FACTOR * 0.2,
                                           NODE_FACTOR * 0.2,
                                           red}));  // no radius: half a voxel; its parent's colour
    CHECK((surfaces[2].look == SurfaceLook{{1, 2, 3}, {4, 6, 3}, 0.5, 0.2, red}));
}

TEST_CASE(
    "a node is as thick as it is where no visible internode comes near that, and its changes reach as far as it is "
    "drawn")
{
    TraceGraph trace;
    const auto change = [&](const TraceChange& what) { trace.apply(what, Direction::forwards); };
    change(TraceNodeChange{0, {}, TraceNode{{10, 10, 10}, 4.0, 1}});
    change(TraceNodeChange{1, {}, TraceNode{{30, 10, 10}, 1.0, 1}});
    const auto drawn = [&](uint32_t node) {
        for (const KeyedSurface& each : surfaces_of(trace, {}, glm::dvec3(1.0)))
            if (each.key == surface_key(SurfaceKind::node, node)) return each.look.radius_from;
        return 0.0;
    };
    CHECK(drawn(0) == 4.0);  // without an internode
    const TraceInternodeChange link{0, {}, TraceInternode{0, 1, 1}};
    change(link);
    CHECK(drawn(0) == NODE_FACTOR * 4.0);
    CHECK(drawn(1) == NODE_FACTOR * 1.0);
    const Change changes[]{link};
    const auto changed = changed_surfaces(trace, {}, glm::dvec3(1.0), changes);
    REQUIRE(changed);
    CHECK(changed->keys.size() == 3);  // both ends, too
    const VoxelBox reach = trace_reach(trace, changes, glm::dvec3(1.0));
    CHECK(double(reach.lower.x) <= 10.0 - NODE_FACTOR * 4.0);
    CHECK(double(reach.upper.y) >= 10.0 + NODE_FACTOR * 4.0);
    change(TraceSizeChange{1, {}, 1.0});  // thin internodes
    CHECK(drawn(0) == 4.0);
    CHECK(drawn(1) == NODE_FACTOR * 1.0);
}
