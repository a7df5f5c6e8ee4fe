#include "haptics/relevance.h"

#include <algorithm>
#include <cmath>

namespace shvr {

bool RelevancePatch::is_well_formed() const
{
    const auto fits = [](int32_t n) { return n > 0 && n <= MAX_VOXELS; };
    return fits(size.x) && fits(size.y) && fits(size.z) && words_per_row >= (size.x + 31) / 32 &&
           words_per_row <= MAX_VOXELS && word_count() <= MAX_WORDS;
}

void RelevancePatch::take_place_of(const RelevancePatch& other)
{
    sequence = other.sequence;
    time_ns = other.time_ns;
    origin = other.origin;
    size = other.size;
    words_per_row = other.words_per_row;
    spacing = other.spacing;
    volume_size = other.volume_size;
    level = other.level;
    settings = other.settings;
    limits = other.limits;
}

bool RelevancePatch::covers(const glm::dvec3& centre, double radius) const
{
    if (sequence == 0) return false;
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = (centre[axis] - radius) / spacing[axis], upper = (centre[axis] + radius) / spacing[axis];
        if (!std::isfinite(lower) || !std::isfinite(upper)) return false;
        // A ball entirely beyond the volume along any axis contains no voxels, so its relevance is known.
        if (upper <= 0.0 || lower >= double(volume_size[axis])) return true;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = std::max((centre[axis] - radius) / spacing[axis], 0.0);
        const double upper = std::min((centre[axis] + radius) / spacing[axis], double(volume_size[axis]));
        if (lower < double(origin[axis]) || upper > double(origin[axis]) + double(size[axis])) return false;
    }
    return true;
}

KnownPart RelevancePatch::known_part(const glm::dvec3& centre, double radius) const
{
    KnownPart known;
    if (covers(centre, radius)) return {glm::dvec3(radius), 1.0};
    if (sequence == 0 || !(radius > 0.0) || !std::isfinite(centre.x + centre.y + centre.z + radius)) return known;
    known.share = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        // Outside the volume nothing is relevant, so the part of the ball beyond the volume's border counts as known.
        const double lower = (centre[axis] - double(origin[axis]) * spacing[axis]);
        const double upper = (double(origin[axis] + size[axis]) * spacing[axis] - centre[axis]);
        double reach = radius;
        if (origin[axis] > 0) reach = std::min(reach, lower);
        if (origin[axis] + size[axis] < volume_size[axis]) reach = std::min(reach, upper);
        const double part = std::max(reach, 0.0) / radius;
        known.reach[axis] = part * radius;
        known.share *= 0.5 * part * (3.0 - part * part);
    }
    return known;
}

}  // namespace shvr
