#pragma once
// Where a label is put next to a line, so that its text does not cross the line. Pure; any thread.

#include <cmath>

#include <glm/glm.hpp>

namespace shvr::ui {

struct LabelPlace {
    glm::dvec2 at{0.0};      ///< pixels of the pane
    glm::dvec2 anchor{0.0};  ///< point of the text that is placed at `at`; 0, 0: upper left corner; 1, 1: lower right
};

/// Returns the place next to the middle of a line, on the side away from `centre`, or above the line if it goes through
/// `centre`. The whole text is on that side, whatever its size. `units`: pixels per unit of the interface.
inline LabelPlace place_next_to(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& centre, double units)
{
    constexpr double GAP = 8.0;           // units
    constexpr double LEVEL_SINE = 0.005;  // a line that is nearly level has its text above its middle
    const glm::dvec2 middle = 0.5 * (from + to), way = to - from;
    const double length = glm::length(way);
    glm::dvec2 side = length > 0.0 ? glm::dvec2(way.y, -way.x) / length : glm::dvec2(0.0, -1.0);
    const double away = glm::dot(middle - centre, side);
    if (std::abs(away) > units ? away < 0.0 : side.y > 0.0) side = -side;
    const auto anchor = [](double part) { return std::abs(part) < LEVEL_SINE ? 0.5 : part > 0.0 ? 0.0 : 1.0; };
    return {middle + GAP * units * side, {anchor(side.x), anchor(side.y)}};
}

}  // namespace shvr::ui
