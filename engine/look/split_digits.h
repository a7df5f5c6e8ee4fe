#pragma once
// Doubles as pairs of floats, for kernels. Any thread.

#include <glm/glm.hpp>

namespace shvr {

/// Sets `whole` to the nearest float, and `rest` to the digits that it loses.
inline void split_digits(double value, float& whole, float& rest)
{
    // volatile: g++ 12 (-ftree-slp-vectorize) leaves out the conversion to float and back, so that no rest is left.
    const volatile auto nearest = float(value);
    whole = nearest;
    rest = float(value - double(nearest));
}
inline void split_digits(const glm::dvec3& value, glm::vec3& whole, glm::vec3& rest)
{
    for (int axis = 0; axis < 3; ++axis) split_digits(value[axis], whole[axis], rest[axis]);
}
inline void split_digits(const glm::dvec2& value, glm::vec2& whole, glm::vec2& rest)
{
    for (int axis = 0; axis < 2; ++axis) split_digits(value[axis], whole[axis], rest[axis]);
}

}  // namespace shvr
