// A trace as balls and rods.

#include "engine/device/trace_surfaces.h"

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("nodes are balls and internodes rods, as thick and as coloured as they are")
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
    CHECK((surfaces[0].look == SurfaceLook{{1, 2, 3}, {1, 2, 3}, 0.5, 0.5, red}));
    CHECK((surfaces[1].look ==
           SurfaceLook{{4, 6, 3}, {4, 6, 3}, 0.2, 0.2, red}));  // no radius: half a voxel; its parent's colour
    CHECK((surfaces[2].look == SurfaceLook{{1, 2, 3}, {4, 6, 3}, 0.5, 0.2, red}));
}
