#pragma once
// Makes a patch of triangles coarser by collapsing its edges, cheapest first (Garland and Heckbert 1997). The patch
// stays a manifold with the same border and the same topology, as do meshes that it is a part of. Pure; any thread.

#include <array>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/progress.h"

namespace shvr {

struct Patch {
    std::vector<glm::dvec3> positions;  ///< in a physical unit
    std::vector<glm::uvec3> triangles;
    /// The two sides' meshes, of which the patch is a part: for each vertex, the first one of the patch that is the
    /// same vertex there. Empty for a side without a mesh.
    std::array<std::vector<uint32_t>, 2> same{};
};

struct PatchLimits {
    size_t triangles = 0;  ///< no further collapse below this number
    double error = 0.0;    ///< the largest that `decimate` may return; above 0
    /// Whether the volume on the inner side may grow by this much; if so, it does. Empty: any change.
    std::function<bool(double change)> may_change{};
};

/// Bytes that `decimate` takes for each triangle, at most.
inline constexpr uint64_t DECIMATION_BYTES_PER_TRIANGLE = 560;

/// Collapses edges until the limits are reached. Vertices at the border of the patch stay where they are. Inside, two
/// vertices become one at a place that keeps the volume. Returns the error: every vertex of the patch as given is
/// within this distance of the triangles that are left, and every point of these of the patch as given. Positions that
/// no triangle uses any more are left as they are.
double decimate(Patch& patch, const PatchLimits& limits, const Progress& progress = {});

}  // namespace shvr
