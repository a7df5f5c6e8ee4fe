#pragma once
// The pull of each mode on the probe. Pure, except for the memory passed in; never allocates.

#include "haptics/growth.h"
#include "haptics/settings.h"

namespace shvr {

struct SurfaceMemory {
    bool is_pinned = false;
    bool is_armed = true;   ///< whether a surface can hold the probe: a release clears this, a small relevant share of
                            ///< the ball sets it again
    glm::dvec3 pin{0.0};    ///< physical
    double farthest = 0.0;  ///< smallest offset of the probe from the pin towards the camera since the pin was set;
                            ///< physical units
};

/// Motion towards the camera, as a share of the probe's radius, that releases a surface; above 0, since hands tremble.
inline constexpr double RELEASE_SHARE = 0.05;
/// Fraction of `surface_share` below which a surface also releases the probe and is armed again.
inline constexpr double SURFACE_HYSTERESIS = 0.75;

struct ModePull {
    glm::dvec3 offset{0.0};  ///< proxy - probe, physical units
    glm::dvec3 middle{0.0};  ///< vector from the probe to the middle of the touched structure, with
                             ///< ForceSettings::finds_middle
    bool in_contact = false;
    double relevant_share = 0.0;
    double known_share = 0.0;  ///< share of the ball whose relevance is known
    bool is_usable = false;    ///< enough of the ball is known, from recent relevance of the present settings
    bool has_lost = false;     ///< object following: the probe is off the object that it followed
    uint32_t object = 0;       ///< number of touched objects or set pins; when it changes, so does the pull's source
};

ModePull pull_of(const ForceSettings& settings, const RelevancePatch& patch, const glm::dvec3& probe, uint64_t now_ns,
                 SurfaceMemory& surface, GrowthMemory& growth) noexcept;

/// Below this known share of the ball, forces fade out, surfaces neither hold nor release, and no object is lost.
inline constexpr double MIN_KNOWN_SHARE = 0.5;
inline constexpr uint64_t RELEVANCE_FRESH_NS = 50'000'000;  ///< older relevance makes the force fade out

}  // namespace shvr
