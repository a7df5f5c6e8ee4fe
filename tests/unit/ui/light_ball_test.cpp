// The light's direction on a ball, and as angles.

#include "engine/workbench/curves/light_ball.h"

#include <initializer_list>

#include <doctest/doctest.h>

using namespace shvr::ui;

TEST_CASE("a place on the ball is a direction, and back")
{
    for (const glm::dvec2& place : {glm::dvec2(0.0), glm::dvec2(0.5, -0.25), glm::dvec2(-0.6, 0.8)}) {
        const glm::dvec3 direction = direction_at(place);
        CHECK(glm::length(direction) == doctest::Approx(1.0));
        CHECK(glm::distance(place_on_ball(direction), place) < 1e-12);
    }
    CHECK(glm::distance(direction_at({3.0, 4.0}), glm::dvec3(0.6, 0.8, 0.0)) < 1e-12);
    // From behind it stands at the edge that is nearest.
    CHECK(glm::distance(place_on_ball(glm::normalize(glm::dvec3(1.0, 0.0, -5.0))), glm::dvec2(1.0, 0.0)) < 1e-12);
}

TEST_CASE("angles are degrees to the right and above, and back")
{
    const LightAngles front = angles_of({0, 0, 1}), right = angles_of({1, 0, 0}), top = angles_of({0, 1, 0});
    CHECK(front.right_degrees == 0.0);
    CHECK(front.up_degrees == 0.0);
    CHECK(right.right_degrees == doctest::Approx(90.0));
    CHECK(top.up_degrees == doctest::Approx(90.0));
    for (const LightAngles& angles : {LightAngles{30, 40}, LightAngles{-120, -10}, LightAngles{170, 80}}) {
        const LightAngles again = angles_of(direction_of(angles));
        CHECK(again.right_degrees == doctest::Approx(angles.right_degrees));
        CHECK(again.up_degrees == doctest::Approx(angles.up_degrees));
    }
    CHECK(glm::distance(light_direction(glm::dvec3(0.0)), glm::normalize(USUAL_LIGHT)) == 0.0);
    CHECK(glm::distance(light_direction({0, 0, 7}), glm::dvec3(0, 0, 1)) == 0.0);
}
