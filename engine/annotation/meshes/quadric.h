#pragma once
// Quadric errors (Garland and Heckbert 1997).

#include <algorithm>

#include <glm/glm.hpp>

namespace shvr {

/// The sum of squared distances to planes.
struct Quadric {
    glm::dmat3 matrix{0.0};
    glm::dvec3 linear{0.0};
    double constant = 0.0;

    void add(const glm::dvec3& normal, const glm::dvec3& point)
    {
        const double offset = -glm::dot(normal, point);
        matrix += glm::outerProduct(normal, normal);
        linear += offset * normal;
        constant += offset * offset;
    }
    Quadric& operator+=(const Quadric& other)
    {
        matrix += other.matrix;
        linear += other.linear;
        constant += other.constant;
        return *this;
    }
    double at(const glm::dvec3& p) const
    {
        return std::max(0.0, glm::dot(p, matrix * p) + 2.0 * glm::dot(linear, p) + constant);
    }
};

}  // namespace shvr
