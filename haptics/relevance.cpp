#include "haptics/relevance.h"

#include <algorithm>
#include <cmath>

namespace shvr {

bool RelevancePatch::covers(const glm::dvec3& centre, double radius) const
{
    if (sequence == 0) return false;
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = (centre[axis] - radius) / spacing[axis], upper = (centre[axis] + radius) / spacing[axis];
        if (!std::isfinite(lower) || !std::isfinite(upper)) return false;
        // A ball outside the volume along any axis contains no voxels, so nothing is unknown.
        if (upper <= 0.0 || lower >= double(volume_size[axis])) return true;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = std::max((centre[axis] - radius) / spacing[axis], 0.0);
        const double upper = std::min((centre[axis] + radius) / spacing[axis], double(volume_size[axis]));
        if (lower < double(origin[axis]) || upper > double(origin[axis]) + double(size[axis])) return false;
    }
    return true;
}

}  // namespace shvr
