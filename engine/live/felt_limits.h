#pragma once
// Which voxels at or above the haptic threshold can be felt: those in chosen groups and, by default, only those that
// the picture shows, so that what is seen is what is felt. Applied where relevance is made, never in the servo's tick;
// limits that hide nothing cost nothing. Plain values; any thread.
//
// A voxel is seen if its centre lies between the cutting and clip planes and its opacity is above 0: its group's, or
// that of the transfer function where it is unpainted. Slices, which ignore both, do not count.

#include <bitset>
#include <optional>
#include <utility>
#include <vector>

#include "engine/look/camera.h"
#include "engine/look/look.h"
#include "engine/volume/volume.h"

namespace shvr {

class Mask;
struct RelevanceBits;

/// Closed intervals of intensities, ascending and apart.
using IntensityIntervals = std::vector<std::pair<double, double>>;
bool contains(const IntensityIntervals& intervals, double intensity);

/// The part of space between two planes across a view's direction, physical units.
struct DepthLimits {
    glm::dvec3 eye{0.0}, forward{0.0, 0.0, 1.0};
    double nearest = 0.0, farthest = 0.0;  ///< along `forward`; the farthest may be infinite
    bool operator==(const DepthLimits&) const = default;
};

struct FeltLimits {
    std::bitset<256> groups = std::bitset<256>().set();  ///< 0 stands for unpainted voxels
    std::optional<IntensityIntervals> unpainted{};       ///< intensities at which those are felt; null: all
    CutBox cut{};
    std::optional<DepthLimits> depths{};
    bool operator==(const FeltLimits&) const = default;
    bool need_mask() const { return !groups.all() || unpainted; }
};

/// The groups that are drawn: visible and, if `opaque`, not fully transparent. [0], unpainted voxels, is always set.
std::bitset<256> drawn_groups(const Groups& groups, bool opaque);

/// Limits touch to `groups`; an empty list: everything.
FeltLimits limits_of_groups(const std::vector<uint8_t>& groups);
/// Limits touch further to what a picture shows. Intensities outside the window are shown as its ends are, and those
/// below the threshold do not matter.
void limit_to_seen(const Look& look, const Camera& camera, const VolumeInfo& volume, const IntensityWindow& window,
                   double threshold, FeltLimits& limits);

/// Intensities at which a function has an opacity above 0, where those outside the window are shown as its ends are.
IntensityIntervals shown_intensities(const TransferFunction& function, const IntensityWindow& window);

/// Clears the voxels that are not felt, except those whose intensity decides (relevance_on_host). `spacing`: of level
/// 0. `mask`: may be null if it is not needed, or nothing is painted.
void apply_limits(const FeltLimits& limits, const glm::dvec3& spacing, const Mask* mask, RelevanceBits& bits);

}  // namespace shvr
