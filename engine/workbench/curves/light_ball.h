#pragma once
// The direction of the light as a point on a ball that is looked at: x right, y up, of the half that faces the viewer.
// Pure; any thread.

#include <glm/glm.hpp>

namespace shvr::ui {

/// Towards the light as it is where no direction is set: over the viewer's shoulder.
inline constexpr glm::dvec3 USUAL_LIGHT{0.3, 0.5, 1.0};

/// A unit vector.
glm::dvec3 light_direction(const glm::dvec3& set);
/// Where the light stands on a ball of radius 1; from behind the ball, at its edge.
glm::dvec2 place_on_ball(const glm::dvec3& direction);
/// The direction of a place; outside the ball, of the nearest place on its edge.
glm::dvec3 direction_at(const glm::dvec2& place);

/// The same in numbers: degrees to the right of the viewer, and above.
struct LightAngles {
    double right_degrees = 0.0, up_degrees = 0.0;
};
LightAngles angles_of(const glm::dvec3& direction);
glm::dvec3 direction_of(const LightAngles& angles);

}  // namespace shvr::ui
