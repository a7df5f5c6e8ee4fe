#pragma once
// The part of a ray that lies in the volume, measured in reference voxels.

#include "tests/reference/scene.h"

namespace shvr::reference {

struct Interval {
    double lower = 0.0;
    double upper = 0.0;
};

/// The interval of t in which the ray is inside the closed box; nothing if it misses. A ray in a face is inside: for
/// axes along which it does not move (+0 or -0) its position decides, not a division.
std::optional<Interval> clip_to_box(const Ray& ray, const glm::dvec3& lower, const glm::dvec3& upper);

/// The part of the interval in which dot(plane.xyz, point) + plane.w is at most 0.
std::optional<Interval> clip_to_plane(const Ray& ray, const glm::dvec4& plane, Interval inside);

/// Points entry + s * step, 0 <= s <= length.
struct Span {
    glm::dvec3 entry{0.0};   ///< voxel space
    glm::dvec3 step{0.0};    ///< voxels per reference voxel of length
    double length = 0.0;     ///< reference voxels
    glm::dvec3 to_eye{0.0};  ///< physical space, unit
    glm::dvec3 at(double s) const { return entry + s * step; }
};

/// The ray inside the volume and what the cuts leave of it; nothing if it misses or has no direction.
std::optional<Span> span_of(const Scene& scene, const Ray& ray);

}  // namespace shvr::reference
