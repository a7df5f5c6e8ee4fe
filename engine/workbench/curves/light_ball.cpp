#include "engine/workbench/curves/light_ball.h"

#include <algorithm>
#include <cmath>

namespace shvr::ui {

glm::dvec3 light_direction(const glm::dvec3& set)
{
    return glm::normalize(set == glm::dvec3(0.0) ? USUAL_LIGHT : set);
}

glm::dvec2 place_on_ball(const glm::dvec3& direction)
{
    const glm::dvec2 place(direction.x, direction.y);
    const double reach = glm::length(place);
    if (direction.z >= 0.0 || reach == 0.0) return place;
    return place / reach;
}

glm::dvec3 direction_at(const glm::dvec2& place)
{
    const double reach = glm::length(place);
    if (reach >= 1.0) return {place / reach, 0.0};
    return {place, std::sqrt(1.0 - reach * reach)};
}

LightAngles angles_of(const glm::dvec3& direction)
{
    return {glm::degrees(std::atan2(direction.x, direction.z)),
            glm::degrees(std::asin(std::clamp(direction.y, -1.0, 1.0)))};
}

glm::dvec3 direction_of(const LightAngles& angles)
{
    const double right = glm::radians(angles.right_degrees), up = glm::radians(angles.up_degrees);
    return {std::sin(right) * std::cos(up), std::sin(up), std::cos(right) * std::cos(up)};
}

}  // namespace shvr::ui
