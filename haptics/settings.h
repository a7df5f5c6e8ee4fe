#pragma once
// What a person chooses of the sense of touch, as the servo gets it: by value, through `Latest`.

#include <cstdint>

#include <glm/glm.hpp>

#include "engine/base/spelling.h"
#include "haptics/proxy.h"

namespace shvr {

/// How the device's workspace lies in the volume: point = origin + to_volume * position_m, a rotation times a scale.
struct Workspace {
    glm::dmat3 to_volume{1.0};  ///< physical units per metre
    glm::dvec3 origin{0.0};     ///< physical
    glm::dvec3 to_point(const glm::dvec3& position_m) const { return origin + to_volume * position_m; }
    double scale() const { return glm::length(to_volume[0]); }
};

enum class HapticMode : uint8_t {
    proximity,  ///< towards the mean of all that is relevant in the ball
    surface,    ///< held where enough of the ball is relevant, until the probe moves towards the camera
    object,     ///< as proximity, but of the object first touched alone
};

inline constexpr Spelling<HapticMode> HAPTIC_MODES[] = {
    {HapticMode::proximity, "proximity"}, {HapticMode::surface, "surface"}, {HapticMode::object, "object"}};
constexpr std::span<const Spelling<HapticMode>> spellings_of(HapticMode)
{
    return HAPTIC_MODES;
}
inline constexpr Spelling<ProxyLaw> PROXY_LAWS[] = {
    {ProxyLaw::potential, "potential"}, {ProxyLaw::mean, "mean"}, {ProxyLaw::thesis, "thesis"}};
constexpr std::span<const Spelling<ProxyLaw>> spellings_of(ProxyLaw)
{
    return PROXY_LAWS;
}

struct ForceSettings {
    bool assistance = false;  ///< off: no force
    ProxyLaw law = ProxyLaw::potential;
    double probe_radius = 1.0;  ///< physical units
    double stiffness = 300.0;   ///< N/m of a probe of PROBE_M in the hand; at the hand never above the device's limit
    double damping = 1.0;       ///< N s/m, at most 1.2
    Workspace workspace;
    uint32_t reset = 0;  ///< a change clears a latched fault
    HapticMode mode = HapticMode::proximity;
    glm::dvec3 to_camera{0.0, 0.0, 1.0};  ///< unit vector in the volume: what releases a surface
    double surface_share = 0.4;           ///< of the ball: a surface holds above it and lets go below 3/4 of it
    double movement_scale = 1.0;          ///< of the hand's moves, as a person set it: divides the force
    double strength = 1.0;                ///< 0 ... 1 of the force
    bool clicks = false;                  ///< a short push where contact begins; of devices with motors alone
    bool let_go = false;                  ///< no force from the next tick on; afterwards it engages anew
    uint32_t relevance_settings = 0;      ///< counts changes of threshold and groups: what was made before fades out
};

/// Radius of a probe in the hand at which `stiffness` acts as it is: ten voxels of 0.25 mm.
inline constexpr double PROBE_M = 0.0025;

}  // namespace shvr
