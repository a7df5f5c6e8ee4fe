#pragma once
// Computes the force on the hand, one tick at a time: proxy, spring, damping, limits. Its only state is the caller's
// `ForceMemory` and `GrowthMemory`: the same inputs give the same forces, bit for bit.
//
//   F = k_hand * offset - b * v - taken, |F| <= peak and the motors' continuous limit, |dF| <= slew per tick,
//   all scaled by the fades;    k_hand = k * (PROBE_M / probe radius in the hand) / movement scale
//
// The scaling is eq. 3.7 of the thesis: a probe that is large in the hand, or moves far, pulls no harder than a small
// one. The stiffness limit applies at the hand, after scaling.
//
// Stability (delay of two ticks, haptic literature: Colgate and Schenkel; Abbott and Okamura): k <= 300 N/m and b = 1.0
// N s/m; velocities are computed from time stamps and smoothed at about 100 Hz, so damping does not depend on the rate.
// Both values apply at the hand, without the scale from device to volume. Only `ProxyLaw::thesis` damps as eq. 3.5
// does, with the difference of two positions; at 1 kHz this damping is equally strong.

#include <cstdint>

#include <glm/glm.hpp>

#include "haptics/device.h"
#include "haptics/modes.h"
#include "haptics/safety.h"
#include "haptics/settings.h"

namespace shvr {

enum ForceFlag : uint32_t {
    FORCE_NO_DEVICE = 1,     ///< lost, silent or not calibrated
    FORCE_NO_REGION = 2,     ///< the relevance around the probe is missing or too old: the force fades out
    FORCE_FAULT = 4,         ///< a position or force is not finite; stays set until ForceSettings::reset changes
    FORCE_CLAMPED = 8,       ///< at the device's peak
    FORCE_ENGAGING = 16,     ///< fading in
    FORCE_WARM = 32,         ///< limited to the motors' continuous force
    FORCE_SLOW = 64,         ///< the device's states arrive too rarely: half the stiffness, or none
    FORCE_OUTSIDE = 128,     ///< outside the box in which the device's forces are accurate
    FORCE_LET_GO = 256,      ///< no force, on the user's request
    FORCE_OFF_OBJECT = 512,  ///< object following: the probe left its object, and may soon touch another
};

/// A pulse against the hand's motion as it touches something, half a sine wave: a hand perceives the onset of contact
/// by its first milliseconds, not by its stiffness (Kuchenbecker, Fiene, Niemeyer: Improving contact realism through
/// event-based haptic feedback, 2006). The pulse is proportional to the hand's speed. It therefore slows even the
/// lightest hand, the free arm of a Touch (45 g), by only 0.6 of its speed, never reverses its motion, and adds no
/// energy. There is no pulse if the hand hardly moves, or has been off surfaces for less than CLICK_PAUSE_NS: a hand
/// that trembles on a surface feels no buzz.
struct ClickMemory {
    glm::dvec3 peak_n{0.0};  ///< peak of the pulse in progress
    uint64_t left_ns = 0;    ///< remaining time of the pulse; 0: no pulse in progress
    uint64_t off_ns = 0;     ///< how long nothing has been touched
};
inline constexpr double CLICK_N = 0.25;
inline constexpr double CLICK_FULL_SPEED = 0.1, CLICK_LEAST_SPEED = 0.01;  ///< m/s
inline constexpr uint64_t CLICK_NS = 16'000'000;  ///< the pulse changes by at most 0.049 N a tick, below GENTLE_SLEW_N
inline constexpr uint64_t CLICK_PAUSE_NS = 100'000'000;

struct ForceMemory {
    bool has_last = false;
    DeviceState last;             ///< the last good state
    DeviceState candidate;        ///< the last rejected state
    int glitches = 0;             ///< number of consecutively rejected states, all near `candidate`
    glm::dvec3 velocity{0.0};     ///< m/s, smoothed
    glm::dvec3 moved_m{0.0};      ///< motion between the last two states, for damping as in the thesis
    glm::dvec3 force_n{0.0};      ///< the last force
    bool has_begun = false;       ///< the engagement is rising
    double engagement = 0.0;      ///< 0 ... 1: fades in after the device has appeared or jumped
    double relevance_fade = 0.0;  ///< 0 ... 1: falls while the relevance is unusable
    double contact_fade = 0.0;    ///< 0 ... 1: fades the damping in and out with contact
    double strength = 0.0;        ///< follows ForceSettings::strength
    uint64_t last_tick_ns = 0;
    uint64_t last_fresh_ns = 0;  ///< when the last fresh state arrived
    uint32_t flags = 0;          ///< FORCE_FAULT is latched
    uint32_t reset = 0;          ///< ForceSettings::reset, last seen

    // State of the cross-fade between two pulls, after a change of mode, law, object or limits
    TouchMode mode = TouchMode::proximity;
    ProxyLaw law = ProxyLaw::potential;
    uint32_t object = 0;
    uint32_t limits = 0;        ///< RelevancePatch::limits
    double cross = 1.0;         ///< 0 ... 1: weight of the present pull; the rest is that of the previous one
    glm::dvec3 spring_n{0.0};   ///< last value
    glm::dvec3 crossed_n{0.0};  ///< the pull that fades out

    ClickMemory click;
    SurfaceMemory surface;
    HeatMemory heat;
    RateMemory rate;
    SentForces sent;
    EnergyMemory energy;
};

struct ForceStep {
    glm::dvec3 force_n{0.0};   ///< device frame
    glm::dvec3 probe{0.0};     ///< physical
    glm::dvec3 velocity{0.0};  ///< velocity of the probe, physical units per second, smoothed
    glm::dvec3 proxy{0.0};     ///< physical position; equals the probe's if there is no contact
    glm::dvec3 middle{0.0};    ///< point where tools act, physical; the probe's unless ForceSettings::finds_middle
    bool in_contact = false;
    double relevant_share = 0.0;
    uint32_t flags = 0;
    uint32_t sequence = 0;   ///< number to write with the force
    double made_j = 0.0;     ///< generated energy, found by the observer, that damping has not removed yet
    uint32_t objects = 0;    ///< number of objects touched so far, in object following
    double latency_s = 0.0;  ///< measured; 0 if the device does not report force numbers
};

inline constexpr uint64_t RELEVANCE_FADE_NS = 100'000'000;    ///< duration of the fade while relevance is unusable
inline constexpr uint64_t CONTACT_FADE_NS = 20'000'000;       ///< keeps damping from setting in abruptly
inline constexpr uint64_t MODE_FADE_NS = 100'000'000;         ///< duration of the cross-fade between two pulls
inline constexpr uint64_t STRENGTH_FADE_NS = 200'000'000;     ///< duration of a fade of the strength from 0 to 1
inline constexpr uint64_t ENGAGE_NS = 1'000'000'000;          ///< for devices with motors
inline constexpr uint64_t ENGAGE_SIMULATED_NS = 100'000'000;  ///< for the mouse
inline constexpr double ENGAGE_BELOW_N = 0.2;                 ///< a device engages only while the force is below
                                                              ///< this, as in CHAI3D: no device starts with a jerk
inline constexpr uint64_t SILENCE_NS = 20'000'000;            ///< a device that is silent for this long is absent
inline constexpr double GLITCH_M = 0.005;                     ///< a hand moves less than this in one tick
inline constexpr int GLITCHES_TO_ACCEPT = 3;                  ///< number of states in a row at a new position after
                                                              ///< which the device counts as moved
inline constexpr double MAX_DAMPING = 1.2;                    ///< N s/m; more is unstable with jitter and no friction
inline constexpr double SLEW_N = 0.1;                         ///< maximum per tick
inline constexpr double GENTLE_SLEW_N = 0.05;  ///< maximum change per tick for a hand of at most GENTLE_SPEED;
                                               ///< proportionally more above
inline constexpr double GENTLE_SPEED = 0.05;   ///< m/s

/// Returns the stiffness at the hand, after scaling and clamping.
double stiffness_at_hand(const ForceSettings& settings, const DeviceCaps& caps, const SentForces& sent);

/// Runs one tick. `now_ns` is the servo's clock, `state` the device's latest state, and `result` the return value of
/// read().
ForceStep step(const ForceSettings& settings, const DeviceCaps& caps, ReadResult result, const DeviceState& state,
               const RelevancePatch& patch, uint64_t now_ns, ForceMemory& memory, GrowthMemory& growth) noexcept;

}  // namespace shvr
