#include "haptics/simulated_device.h"

#include <cmath>

#include "engine/base/error.h"

namespace shvr {
namespace {

/// Returns exp(a) by scaling, Taylor series and squaring. The series is used for norms below 1/16: remainder 1e-16.
glm::dmat2 exponential(glm::dmat2 a)
{
    int halvings = 0;
    for (; std::abs(a[0][0]) + std::abs(a[0][1]) + std::abs(a[1][0]) + std::abs(a[1][1]) > 1.0 / 16.0; ++halvings)
        a *= 0.5;
    glm::dmat2 sum(1.0), term(1.0);
    for (int n = 1; n <= 10; ++n) {
        term = term * a / double(n);
        sum += term;
    }
    for (; halvings > 0; --halvings) sum = sum * sum;
    return sum;
}

/// Returns the exact motion over a tick with constant wish and force. Being exact, it is stable for any hand and tick.
glm::dmat2 propagator_of(const HandModel& hand)
{
    if (hand.mass_kg > 0.0) {
        const double k = hand.stiffness / hand.mass_kg, b = hand.damping / hand.mass_kg;
        return exponential(glm::dmat2(0.0, -k, 1.0, -b) * hand.tick_s);  // columns
    }
    const double decay = hand.damping > 0.0 ? std::exp(-hand.stiffness * hand.tick_s / hand.damping) : 0.0;
    return {decay, 0.0, 0.0, 0.0};
}

}  // namespace

SimulatedDevice::SimulatedDevice(const HandModel& model) : model_(model)
{
    SHVR_CHECK(model.mass_kg >= 0.0 && model.stiffness > 0.0 && model.damping >= 0.0 && model.tick_s > 0.0,
               model.mass_kg, " kg, ", model.stiffness, " N/m, ", model.damping, " N s/m, ", model.tick_s, " s");
    SHVR_CHECK(model.delay_ticks >= 0 && model.delay_ticks < int(in_flight_.size()), model.delay_ticks);
    propagator_ = propagator_of(model);
}

DeviceCaps SimulatedDevice::caps() const noexcept
{
    return {.usable_lower_m = glm::dvec3(-MAX_REACH_M),
            .usable_upper_m = glm::dvec3(MAX_REACH_M),
            .latency_s = model_.delay_ticks * model_.tick_s,
            .outputs_force = model_.mass_kg > 0.0,
            .tells_force_sequence = true};
}

ReadResult SimulatedDevice::read(DeviceState& state) noexcept
{
    wish_.take();
    const HandWish& wish = wish_.value();
    if (wish.jump != jump_) {
        jump_ = wish.jump;
        position_m_ = wish.position_m;
        velocity_ = glm::dvec3(0.0);
        in_flight_.fill({});  // forces written at the old position must have no effect at the new one
    }
    // write() stores this tick's force in the slot of `ticks_`. Without a write, the last force stays in effect.
    const size_t slots = in_flight_.size();
    const Written& applied = in_flight_[(ticks_ + slots - size_t(model_.delay_ticks)) % slots];
    const glm::dvec3 rest = wish.position_m + applied.force_n / model_.stiffness;
    const glm::dvec3 away = position_m_ - rest;
    position_m_ = rest + propagator_[0][0] * away + propagator_[1][0] * velocity_;
    velocity_ = propagator_[0][1] * away + propagator_[1][1] * velocity_;

    state = {};
    state.force_sequence = applied.sequence;
    ++ticks_;
    in_flight_[ticks_ % slots] = in_flight_[(ticks_ + slots - 1) % slots];
    state.time_ns = uint64_t(std::llround(double(ticks_) * model_.tick_s * 1e9));
    state.sequence = uint32_t(ticks_);
    state.position_m = position_m_;
    state.buttons = wish.buttons;
    state.jump = jump_;
    return ReadResult::fresh;
}

bool SimulatedDevice::write(const glm::dvec3& force_n, uint32_t sequence) noexcept
{
    in_flight_[ticks_ % in_flight_.size()] = {is_finite(force_n) ? force_n : glm::dvec3(0.0), sequence};
    return true;
}

}  // namespace shvr
