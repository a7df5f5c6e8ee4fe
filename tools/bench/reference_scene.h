#pragma once
// Converts a session for the reference renderer (tests/reference): the volume as the device holds it (16-bit codes),
// transfer function, groups, light, cut, and the balls among its surfaces. Any thread.

#include <span>

#include "engine/annotation/mask.h"
#include "engine/session/session.h"
#include "tests/reference/render.h"

namespace shvr::bench {

/// A ball at which rays stop.
struct Ball {
    glm::dvec3 center{0.0};  ///< physical
    double radius = 1.0;
    glm::dvec3 color{1.0};  ///< linear light
};

struct ReferenceScene {
    reference::Scene scene;
    std::vector<Ball> balls;
};

/// Uses 8 bytes per voxel. `mask`: null if nothing is painted. Fails if the session shows something that the reference
/// does not support (rods, a trace, slices, distance blending) or has more voxels than MAX_REFERENCE_VOXELS. Exact
/// ambient occlusion takes seconds: it is computed for each voxel near which something is visible.
ReferenceScene reference_scene_of(const Session& session, const VolumeSource& source,
                                  const VolumeStatistics& statistics, const Camera& camera, const Mask* mask);
inline constexpr int64_t MAX_REFERENCE_VOXELS = int64_t{1} << 29;

/// Rays through the centres of pixels.
std::vector<reference::Ray> rays_through(std::span<const glm::uvec2> pixels, const RayPlanes& planes);

/// Traces rays. Returns linear light, premultiplied, composited over the session's background, in the order of `rays`.
std::vector<glm::dvec4> draw(const ReferenceScene& scene, std::span<const reference::Ray> rays,
                             const reference::Mode& mode, const glm::dvec4& background, int threads);

}  // namespace shvr::bench
