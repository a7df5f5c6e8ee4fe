#pragma once
// Shows the direction of the light as a point on a ball, in the half that faces the viewer: x right, y up. Pure; any
// thread.

#include <glm/glm.hpp>

namespace shvr::ui {

/// Direction towards the light if the session sets none: over the viewer's shoulder.
inline constexpr glm::dvec3 USUAL_LIGHT{0.3, 0.5, 1.0};

/// Returns a unit vector.
glm::dvec3 light_direction(const glm::dvec3& set);
/// Projects a direction onto a ball of radius 1. Light from behind the ball is shown at the ball's edge.
glm::dvec2 place_on_ball(const glm::dvec3& direction);
/// Returns the direction that a point on the ball stands for. Points outside the ball are first moved to its edge.
glm::dvec3 direction_at(const glm::dvec2& place);

/// The direction as angles: degrees to the right of the viewer, and degrees above the viewer.
struct LightAngles {
    double right_degrees = 0.0, up_degrees = 0.0;
};
LightAngles angles_of(const glm::dvec3& direction);
glm::dvec3 direction_of(const LightAngles& angles);

}  // namespace shvr::ui
