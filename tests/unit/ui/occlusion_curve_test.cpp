// The curve of ambient occlusion, as a hand edits it.

#include "engine/workbench/curves/occlusion_curve.h"

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

TEST_CASE("a power is what is seen until there are points, which are linear in between and level outside")
{
    CHECK(seen_of({.curve = 2.0}, 0.5) == 0.25);
    const OcclusionSettings settings{.curve = 2.0, .mapping = {{0.2, 0.1}, {0.6, 0.1}, {0.6, 0.8}, {0.8, 0.9}}};
    CHECK(seen_of(settings, 0.0) == 0.1);
    CHECK(seen_of(settings, 0.4) == doctest::Approx(0.1));
    CHECK(seen_of(settings, 0.6) == 0.8);  // a step
    CHECK(seen_of(settings, 0.7) == doctest::Approx(0.85));
    CHECK(seen_of(settings, 1.0) == 0.9);
    const OcclusionSettings as_points{.mapping = points_of_power(2.0)};
    for (const double share : {0.0, 0.25, 0.5, 1.0}) CHECK(seen_of(as_points, share) == share * share);
}

TEST_CASE("points of the light's curve are found, moved between their neighbours, added and removed")
{
    OcclusionPoints points = points_of_power(1.0);
    CHECK(point_under(points, {0.51, 0.48}, {0.05, 0.05}) == 2u);
    CHECK_FALSE(point_under(points, {0.4, 0.5}, {0.05, 0.05}));
    CHECK(moved(points, 2, {0.9, 1.5})[2] == OcclusionPoint{0.75, 1.0});
    CHECK(moved(points, 0, {-1.0, -1.0})[0] == OcclusionPoint{0.0, 0.0});
    CHECK(moved(points, 4, {0.1, 0.5})[4] == OcclusionPoint{0.75, 0.5});
    CHECK(add(points, {0.6, 0.9}) == 3);
    CHECK(points.size() == 6);
    CHECK(points[3] == OcclusionPoint{0.6, 0.9});
    CHECK(without(points, 3) == points_of_power(1.0));
    CHECK(in_widest_gap({{0.0, 0.0}, {0.2, 0.5}, {1.0, 0.9}}) == OcclusionPoint{0.6, 0.7});
    CHECK(in_widest_gap({{0.6, 0.5}, {0.8, 0.9}}) == OcclusionPoint{0.3, 0.5});
    while (points.size() < MAX_OCCLUSION_POINTS) add(points, in_widest_gap(points));
    const OcclusionPoints full = points;
    add(points, {0.3, 0.3});
    CHECK(points == full);
    while (points.size() > 2) points = without(points, 0);
    CHECK(without(points, 1) == points);
}
