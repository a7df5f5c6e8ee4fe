#pragma once
// Limits which voxels at or above the haptic threshold can be felt: those in chosen groups and, by default, only those
// that the picture shows, so that users feel what they see. Applied where relevance is computed, never in the servo's
// tick; limits that hide nothing cost nothing. Plain values; any thread.
//
// A voxel is seen if its centre lies between the cutting and clip planes and its opacity is above 0: its group's
// opacity, or the transfer function's if it is unpainted. Slices ignore planes and opacity, so they do not count.

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

/// Closed intervals of intensities, in ascending order, that neither overlap nor touch.
using IntensityIntervals = std::vector<std::pair<double, double>>;
bool contains(const IntensityIntervals& intervals, double intensity);

/// The space between two planes that are perpendicular to a view's direction, in physical units.
struct DepthLimits {
    glm::dvec3 eye{0.0}, forward{0.0, 0.0, 1.0};
    double nearest = 0.0, farthest = 0.0;  ///< along `forward`; the farthest may be infinite
    bool operator==(const DepthLimits&) const = default;
};

struct FeltLimits {
    std::bitset<256> groups = std::bitset<256>().set();  ///< 0 stands for unpainted voxels
    std::optional<IntensityIntervals> unpainted{};       ///< intensities at which unpainted voxels are felt; null: any
    CutBox cut{};                                        ///< planes along the axes only
    glm::dvec4 plane{0.0};                               ///< not felt where dot(xyz, voxel) + w > 0
    std::optional<DepthLimits> depths{};
    bool operator==(const FeltLimits&) const = default;
    bool need_mask() const { return !groups.all() || unpainted; }
};

/// Returns the drawn groups: visible and, if `opaque`, not fully transparent. Bit 0 (unpainted) is always set.
std::bitset<256> drawn_groups(const Groups& groups, bool opaque);

/// Returns limits that allow only `groups` to be felt, or every group if the list is empty.
FeltLimits limits_of_groups(const std::vector<uint8_t>& groups);
/// Narrows `limits` to the voxels that a picture shows. Intensities outside the window are shown like the window's
/// nearer end; intensities below the threshold do not matter.
void limit_to_seen(const Look& look, const Camera& camera, const VolumeInfo& volume, const IntensityWindow& window,
                   double threshold, FeltLimits& limits);

/// Returns the intensities with opacity above 0. Intensities outside the window have the opacity of its nearer end.
IntensityIntervals shown_intensities(const TransferFunction& function, const IntensityWindow& window);

/// Clears the bits of voxels that cannot be felt, except voxels excluded by intensity alone (relevance_on_host clears
/// those). `spacing`: voxel spacing of level 0. `mask`: may be null if no limit needs it, or if nothing is painted.
void apply_limits(const FeltLimits& limits, const glm::dvec3& spacing, const Mask* mask, RelevanceBits& bits);

}  // namespace shvr
