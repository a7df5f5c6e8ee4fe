#include "haptics/safety.h"

#include <algorithm>
#include <cmath>

namespace shvr {
namespace {

/// A device's stiffness limit holds for a total delay: two ticks (2 ms), half a tick during which a force is held, and
/// the delay of smoothing the velocity at 100 Hz (fitted to K = 300 B at two ticks).
constexpr double USUAL_LATENCY_S = 0.002, HELD_S = 0.0005, VELOCITY_LAG_S = 0.00083;
constexpr double LATENCY_SMOOTHING_S = 0.1;
constexpr double SLOWEST_TAKEN = 0.002;  ///< speed in m/s below which damping is off, to avoid a division by nearly 0

double at_least_zero(double value, double most)
{
    return value > 0.0 ? std::min(value, most) : 0.0;  // 0 for NaN
}

}  // namespace

double force_allowed(const DeviceCaps& caps, const HeatMemory& heat)
{
    const double held = caps.continuous_force_n * caps.continuous_force_n / (1.0 + HEAT_S / HEAT_WINDOW_S);
    const double peak = caps.peak_force_n * caps.peak_force_n;
    if (peak <= held) return caps.peak_force_n;
    const double cool = held > 0.0 ? std::clamp(2.0 * (held - heat.square) / held, 0.0, 1.0) : 0.0;
    return std::sqrt(held + (peak - held) * cool);
}

void add_heat(const glm::dvec3& force_n, double dt_s, HeatMemory& heat)
{
    heat.square += (1.0 - std::exp(-dt_s / HEAT_S)) * (glm::dot(force_n, force_n) - heat.square);
}

void add_state(uint64_t now_ns, RateMemory& rate)
{
    rate.fresh_ns[rate.count++ % SLOW_STATES] = now_ns;
    if (rate.count >= 2 * SLOW_STATES) rate.count -= uint32_t(SLOW_STATES);  // never wraps
}

double share_for_rate(uint64_t now_ns, const RateMemory& rate)
{
    if (rate.count < SLOW_STATES) return 1.0;
    // Returns whether the last `intervals` intervals together took longer than `most_ns`.
    const auto is_late = [&](size_t intervals, uint64_t most_ns) {
        const uint64_t then_ns = rate.fresh_ns[(rate.count - intervals - 1) % SLOW_STATES];
        return now_ns > then_ns && now_ns - then_ns > most_ns;
    };
    if (is_late(TOO_SLOW_STATES, RATE_WINDOW_NS)) return 0.0;
    return is_late(SLOW_STATES - 1, RATE_WINDOW_NS * (SLOW_STATES - 1) / SLOW_STATES) ? 0.5 : 1.0;
}

void add_sent(const glm::dvec3& force_n, uint64_t now_ns, SentForces& sent)
{
    ++sent.sequence;
    sent.ring[sent.sequence % sent.ring.size()] = {force_n, now_ns, sent.sequence};
}

SentForce force_in_effect(const DeviceCaps& caps, const DeviceState& state, uint64_t now_ns, const SentForces& sent)
{
    if (caps.tells_force_sequence) {
        const SentForce& told = sent.ring[state.force_sequence % sent.ring.size()];
        return told.sequence == state.force_sequence ? told : SentForce{};
    }
    const auto latency_ns = uint64_t(caps.latency_s * 1e9);
    for (size_t back = 0; back < sent.ring.size(); ++back) {
        const SentForce& one = sent.ring[(sent.sequence - back) % sent.ring.size()];
        if (one.sequence == 0) break;
        if (now_ns - one.time_ns >= latency_ns) return one;
    }
    return {};
}

void measure_latency(const DeviceCaps& caps, const DeviceState& state, uint64_t now_ns, double tick_s, SentForces& sent)
{
    if (!caps.tells_force_sequence || state.force_sequence == 0) return;
    const SentForce effect = force_in_effect(caps, state, now_ns, sent);
    if (effect.sequence == 0 || now_ns < effect.time_ns) return;
    // A force acts for one tick before the device reports it in a state, so that tick is not part of the latency.
    const double latency_s = std::max(double(now_ns - effect.time_ns) * 1e-9 - tick_s, 0.0);
    const double share = 1.0 - std::exp(-tick_s / LATENCY_SMOOTHING_S);
    sent.latency_s += share * (latency_s - sent.latency_s);
}

double stable_stiffness(const DeviceCaps& caps, const SentForces& sent)
{
    constexpr double lag_s = HELD_S + VELOCITY_LAG_S;
    const double latency_s = std::max({USUAL_LATENCY_S, caps.latency_s, sent.latency_s});
    return caps.stiffness_limit * (USUAL_LATENCY_S + lag_s) / (latency_s + lag_s);
}

void observe_energy(const glm::dvec3& position_m, const glm::dvec3& field_n, const glm::dvec3& in_effect_n,
                    EnergyMemory& energy)
{
    if (energy.has_last) {
        const glm::dvec3 moved = position_m - energy.position_m;
        const double work = glm::dot(in_effect_n - 0.5 * (energy.field_n + field_n), moved);
        energy.made_j = std::isfinite(work) ? std::max(energy.made_j + work, 0.0) : 0.0;
    }
    energy.has_last = true;
    energy.position_m = position_m;
    energy.field_n = field_n;
}

glm::dvec3 take_energy(const glm::dvec3& velocity, double dt_s, EnergyMemory& energy)
{
    const double speed = glm::length(velocity);
    if (!(energy.made_j > 0.0) || !(dt_s > 0.0) || !(speed > SLOWEST_TAKEN)) return glm::dvec3(0.0);
    const double strength = std::min({energy.made_j / (speed * dt_s), MAX_TAKING * speed, TAKING_MOST_N});
    energy.made_j = std::max(energy.made_j - strength * speed * dt_s, 0.0);
    return -strength * velocity / speed;
}

double share_in_box(const DeviceCaps& caps, const glm::dvec3& position_m)
{
    const glm::dvec3 outside =
        glm::max(glm::max(caps.usable_lower_m - position_m, position_m - caps.usable_upper_m), glm::dvec3(0.0));
    return std::clamp(1.0 - glm::length(outside) / BOX_MARGIN_M, 0.0, 1.0);
}

DeviceCaps sane(DeviceCaps caps)
{
    caps.peak_force_n = at_least_zero(caps.peak_force_n, 40.0);
    caps.continuous_force_n = at_least_zero(caps.continuous_force_n, caps.peak_force_n);
    caps.stiffness_limit = at_least_zero(caps.stiffness_limit, 10'000.0);
    caps.latency_s = std::isfinite(caps.latency_s) ? std::clamp(caps.latency_s, 0.0, 1.0) : 1.0;
    return caps;
}

}  // namespace shvr
