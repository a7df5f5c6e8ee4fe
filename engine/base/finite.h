#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace shvr {

/// Whether no component is infinite or NaN.
inline bool is_finite(const glm::dvec3& vector)
{
    return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

}  // namespace shvr
