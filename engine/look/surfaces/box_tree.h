#pragma once
// A hierarchy of boxes around surfaces of any kind, in depth-first order, in which each box has a skip link
// (shaders/surfaces.h). Plain data; any thread.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "shaders/surfaces.h"

namespace shvr {

struct SurfaceBox {
    glm::dvec3 lower{INFINITY}, upper{-INFINITY};
    void add(const glm::dvec3& low, const glm::dvec3& high)
    {
        lower = glm::min(lower, low), upper = glm::max(upper, high);
    }
    void add(const SurfaceBox& box) { add(box.lower, box.upper); }
    double half_area() const;
};

struct BoxedSurface {
    SurfaceBox box;
    glm::dvec3 middle{0.0};
    uint32_t surface = 0;  ///< index of the caller's surface
};

/// Splits by the surface area heuristic (MacDonald and Booth 1990), evaluated over bins (Wald 2007). Sorts `items` into
/// the order of the leaves, whose ranges they are; no leaf holds more than `max_in_leaf`.
std::vector<gpu::SurfaceNode> box_tree(std::span<BoxedSurface> items, size_t max_in_leaf);

/// Single precision, below or above all that rounds to the same value.
glm::vec3 rounded_down(const glm::dvec3& v);
glm::vec3 rounded_up(const glm::dvec3& v);

}  // namespace shvr
