#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace shvr {

/// Neither infinite nor NaN, along any axis.
inline bool is_finite(const glm::dvec3& vector)
{
    return std::isfinite(vector.x) && std::isfinite(vector.y) && std::isfinite(vector.z);
}

}  // namespace shvr
