#pragma once
// The user's settings of the sense of touch, as passed to the servo: by value, through `Latest`.

#include <cstdint>

#include <glm/glm.hpp>

#include "engine/touch/touch_mode.h"
#include "haptics/proxy.h"

namespace shvr {

/// Maps the device's workspace into the volume: point = origin + to_volume * position_m. Rotates and scales uniformly.
struct Workspace {
    glm::dmat3 to_volume{1.0};  ///< physical units per metre
    glm::dvec3 origin{0.0};     ///< physical
    glm::dvec3 to_point(const glm::dvec3& position_m) const { return origin + to_volume * position_m; }
    double scale() const { return glm::length(to_volume[0]); }
    bool operator==(const Workspace&) const = default;
};

struct ForceSettings {
    bool assistance = false;  ///< off: no force
    ProxyLaw law = ProxyLaw::potential;
    double probe_radius = 1.0;  ///< physical units
    double stiffness = 300.0;   ///< N/m for a probe of PROBE_M in the hand; the device's limit applies after scaling
    double damping = 1.0;       ///< N s/m, at most 1.2
    Workspace workspace;
    uint32_t reset = 0;  ///< a change clears a latched fault
    TouchMode mode = TouchMode::proximity;
    glm::dvec3 to_camera{0.0, 0.0, 1.0};  ///< unit vector in the volume; motion along it releases a surface
    double surface_share = 0.4;           ///< share of the ball from which a surface holds the probe; below 3/4 of it,
                                          ///< it lets go
    double movement_scale = 1.0;          ///< user's scale of the hand's motion; the force is divided by it
    double strength = 1.0;                ///< factor of the force, 0 ... 1
    bool clicks = false;                  ///< a short pulse when contact begins; only for devices with motors
    bool let_go = false;                  ///< no force from the next tick on; once false again, the force fades in
    bool finds_middle = false;            ///< tools act at the middle of the touched structure; no effect on the force
    uint32_t relevance_settings = 0;      ///< counts changes of threshold and groups; forces from older relevance fade
    bool operator==(const ForceSettings&) const = default;
};

/// Radius of a probe in the hand at which `stiffness` applies unscaled: ten voxels of 0.25 mm.
inline constexpr double PROBE_M = 0.0025;

}  // namespace shvr
