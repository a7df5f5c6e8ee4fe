#pragma once
// What keeps forces safe besides the peak and the slew limit, each with its own small memory: heat, rate, latency,
// energy, the box in which a device's forces are right. Pure; never allocates. SI units.

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

#include "haptics/device.h"

namespace shvr {

// ---- Heat: no 10 s have a root mean square above the continuous force ----------------------------------------------

/// The square of the force, smoothed with HEAT_S, stays at or below continuous^2 / (1 + HEAT_S / 10 s). As 10 s of
/// squares add up to HEAT_S times its growth plus 10 s of it, their mean is at most continuous^2.
inline constexpr double HEAT_S = 2.0;
inline constexpr double HEAT_WINDOW_S = 10.0;
struct HeatMemory {
    double square = 0.0;  ///< N^2
};
/// The largest force now: the peak while cool, then less and less, and what can be held for ever where it is hot.
double force_allowed(const DeviceCaps& caps, const HeatMemory& heat);
void add_heat(const glm::dvec3& force_n, double dt_s, HeatMemory& heat);

// ---- Rate: fewer than 400 states a second halve the stiffness, fewer than 200 end the force -------------------------

inline constexpr uint64_t RATE_WINDOW_NS = 20'000'000;
inline constexpr size_t SLOW_STATES = 8, TOO_SLOW_STATES = 4;  ///< per window: 400 and 200 a second
struct RateMemory {
    std::array<uint64_t, SLOW_STATES> fresh_ns{};  ///< ring of times
    uint32_t count = 0;                            ///< of states since the device appeared
};
void add_state(uint64_t now_ns, RateMemory& rate);
/// 1, 1/2 or 0 of the stiffness. 1 until enough states came to tell.
double share_for_rate(uint64_t now_ns, const RateMemory& rate);

// ---- What was sent, and what was in effect when ---------------------------------------------------------------------

struct SentForce {
    glm::dvec3 force_n{0.0};
    uint64_t time_ns = 0;
    uint32_t sequence = 0;
};
struct SentForces {
    std::array<SentForce, 64> ring{};
    uint32_t sequence = 0;   ///< of the last
    double latency_s = 0.0;  ///< measured, smoothed; 0: not yet
};
void add_sent(const glm::dvec3& force_n, uint64_t now_ns, SentForces& sent);
/// The force in effect at a state: by the number the device tells or, from one that tells none, by its latency.
SentForce force_in_effect(const DeviceCaps& caps, const DeviceState& state, uint64_t now_ns, const SentForces& sent);
void measure_latency(const DeviceCaps& caps, const DeviceState& state, uint64_t now_ns, double tick_s,
                     SentForces& sent);

/// Stiffness that is stable at the latency the device states, or has where that is longer. Its own limit holds for two
/// ticks; beyond, K (latency + half a tick + the velocity's lag) stays the same.
double stable_stiffness(const DeviceCaps& caps, const SentForces& sent);

// ---- Energy: the passivity observer and controller of Hannaford and Ryu ---------------------------------------------

/// Work of the forces in effect, less that of the undelayed field of forces along the same way: what delay, holding and
/// limits made. It is taken back by damping, in the direction of motion.
struct EnergyMemory {
    bool has_last = false;
    glm::dvec3 position_m{0.0}, field_n{0.0};  ///< of the last state: where, and what an undelayed force was there
    double made_j = 0.0;                       ///< not taken back yet; at least 0
};
inline constexpr double MAX_TAKING = 2.0;  ///< N s/m: more damping is itself unstable at two ticks
inline constexpr double TAKING_MOST_N = 0.3;
void observe_energy(const glm::dvec3& position_m, const glm::dvec3& field_n, const glm::dvec3& in_effect_n,
                    EnergyMemory& energy);
/// The force that takes energy back over `dt_s`, which counts as taken.
glm::dvec3 take_energy(const glm::dvec3& velocity, double dt_s, EnergyMemory& energy);

// ---- The box ----------------------------------------------------------------------------------------------------------

/// 1 inside the box where the device's forces are right, falling to 0 over BOX_MARGIN_M outside.
inline constexpr double BOX_MARGIN_M = 0.01;
double share_in_box(const DeviceCaps& caps, const glm::dvec3& position_m);

/// Limits that make sense: what is no number or below 0 becomes 0, and nothing exceeds what any such device has.
DeviceCaps sane(DeviceCaps caps);

}  // namespace shvr
