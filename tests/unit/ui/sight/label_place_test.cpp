// Labels next to lines: no text crosses its line.

#include "engine/workbench/sight/label_place.h"

#include <numbers>

#include <doctest/doctest.h>

using namespace shvr::ui;

TEST_CASE("a label is next to its line, whatever the direction, and away from the drawing's centre")
{
    const glm::dvec2 text(140.0, 16.0), middle(300.0, 200.0);
    for (const double units : {1.0, 2.0})
        for (int degrees = 0; degrees < 360; degrees += 3) {
            CAPTURE(degrees);
            const double angle = degrees * std::numbers::pi / 180.0;
            const glm::dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
            for (const glm::dvec2& centre : {middle, middle + 30.0 * across, middle - 30.0 * across}) {
                const LabelPlace place = place_next_to(middle - 50.0 * along, middle + 50.0 * along, centre, units);
                const glm::dvec2 corner = place.at - place.anchor * text;
                const double sign = glm::dot(place.at - middle, across) > 0.0 ? 1.0 : -1.0;
                for (const glm::dvec2& share : {glm::dvec2(0.0), {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}})
                    CHECK(sign * glm::dot(corner + share * text - middle, across) > 7.0 * units);
                if (centre != middle) CHECK(sign * glm::dot(centre - middle, across) < 0.0);
            }
        }
    // A line without length has its text above it.
    const LabelPlace place = place_next_to(middle, middle, middle, 1.0);
    CHECK(place.at == middle - glm::dvec2(0.0, 8.0));
    CHECK(place.anchor == glm::dvec2(0.5, 1.0));
}
