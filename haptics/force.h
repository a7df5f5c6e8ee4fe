#pragma once
// Computes the force on the hand, one tick at a time: proxy, spring, damping, limits. Its only state is the caller's
// `ForceMemory`: the same inputs give the same forces, bit for bit.
//
//   F = k * offset - b * v, |F| <= peak, |dF| <= slew per tick, all scaled by the fades
//
// Stability (delay of two ticks, haptic literature: Colgate and Schenkel; Abbott and Okamura): k <= 300 N/m and
// b = 1.0 N s/m; velocities come from time stamps and are smoothed at about 100 Hz, so damping does not depend on the
// rate. Both apply at the hand, without the scale from device to volume.

#include <cstdint>

#include <glm/glm.hpp>

#include "haptics/device.h"
#include "haptics/proxy.h"

namespace shvr {

/// How the device's workspace lies in the volume: point = origin + to_volume * position_m, a rotation times a scale.
struct Workspace {
    glm::dmat3 to_volume{1.0};  ///< physical units per metre
    glm::dvec3 origin{0.0};     ///< physical
    glm::dvec3 to_point(const glm::dvec3& position_m) const { return origin + to_volume * position_m; }
    double scale() const { return glm::length(to_volume[0]); }
};

struct ForceSettings {
    bool assistance = false;  ///< off: no force
    ProxyLaw law = ProxyLaw::potential;
    double probe_radius = 1.0;  ///< physical units
    double stiffness = 300.0;   ///< N/m; never above the device's limit
    double damping = 1.0;       ///< N s/m, at most 1.2
    Workspace workspace;
    uint32_t reset = 0;  ///< a change clears a latched fault
};

enum ForceFlag : uint32_t {
    FORCE_NO_DEVICE = 1,  ///< lost, silent or not calibrated
    FORCE_NO_REGION = 2,  ///< the relevance around the probe is missing or too old: the force fades out
    FORCE_FAULT = 4,      ///< a non-finite position or force; latched until the memory is replaced
    FORCE_CLAMPED = 8,    ///< at the device's peak
    FORCE_ENGAGING = 16,  ///< fading in
};

struct ForceMemory {
    bool has_last = false;
    DeviceState last;             ///< the last good state
    DeviceState candidate;        ///< the last rejected state
    int glitches = 0;             ///< rejected states in a row, all near `candidate`
    glm::dvec3 velocity{0.0};     ///< m/s, smoothed
    glm::dvec3 force_n{0.0};      ///< the last force
    bool has_begun = false;       ///< the engagement is rising
    double engagement = 0.0;      ///< 0 ... 1: fades in after the device appeared or jumped
    double relevance_fade = 0.0;  ///< 0 ... 1: falls while the relevance is unusable
    double contact_fade = 0.0;    ///< 0 ... 1: of the damping
    uint64_t last_tick_ns = 0;
    uint64_t last_fresh_ns = 0;  ///< when the last fresh state arrived
    uint32_t flags = 0;          ///< FORCE_FAULT is latched
};

struct ForceStep {
    glm::dvec3 force_n{0.0};  ///< device frame
    glm::dvec3 probe{0.0};    ///< physical
    glm::dvec3 proxy{0.0};    ///< physical; the probe where there is no contact
    bool in_contact = false;
    double relevant_share = 0.0;
    uint32_t flags = 0;
};

inline constexpr uint64_t RELEVANCE_FRESH_NS = 50'000'000;    ///< with older relevance the force fades
inline constexpr uint64_t RELEVANCE_FADE_NS = 100'000'000;    ///< duration of that fade
inline constexpr uint64_t CONTACT_FADE_NS = 20'000'000;       ///< keeps damping from setting in abruptly
inline constexpr uint64_t ENGAGE_NS = 1'000'000'000;          ///< for devices with motors
inline constexpr uint64_t ENGAGE_SIMULATED_NS = 100'000'000;  ///< for the mouse
inline constexpr double ENGAGE_BELOW_N = 0.2;                 ///< as in chai3d: a device never starts with a pull
inline constexpr uint64_t SILENCE_NS = 20'000'000;            ///< a device silent for that long counts as absent
inline constexpr double GLITCH_M = 0.005;                     ///< no hand moves that far in one tick
inline constexpr int GLITCHES_TO_ACCEPT = 3;                  ///< in a row at the new position: the device was moved
inline constexpr double MAX_REACH_M = 10.0;                   ///< no device reaches farther
inline constexpr double MAX_DAMPING = 1.2;                    ///< N s/m; more is unstable with jitter and no friction
inline constexpr double SLEW_N = 0.1;                         ///< per tick

/// One tick. `now_ns` is the servo's clock; `state` is the device's latest state and `result` what read() returned.
ForceStep step(const ForceSettings& settings, const DeviceCaps& caps, ReadResult result, const DeviceState& state,
               const RelevancePatch& patch, uint64_t now_ns, ForceMemory& memory) noexcept;

}  // namespace shvr
