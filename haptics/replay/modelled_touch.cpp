#include "haptics/replay/modelled_touch.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/finite.h"

namespace shvr {
namespace {
constexpr double STEP_S = 50e-6;
}

ModelledTouch::ModelledTouch(const TouchModel& model) : model_(model), random_(model.seed)
{
    SHVR_CHECK(model.arm_kg > 0.0 && model.hand_kg >= 0.0 && model.tick_s > 0.0, model.arm_kg, " kg");
    SHVR_CHECK(model.delay_ticks >= 0 && model.delay_ticks < int(in_flight_.size()), model.delay_ticks);
    SHVR_CHECK(model.jitter_s >= 0.0 && model.jitter_s <= 0.5 * model.tick_s, model.jitter_s);
}

DeviceCaps ModelledTouch::caps() const noexcept
{
    return {.usable_lower_m = glm::dvec3(-MAX_REACH_M),  // wishes lie where the trace's positions lie
            .usable_upper_m = glm::dvec3(MAX_REACH_M),
            .peak_force_n = model_.peak_n,
            .latency_s = model_.delay_ticks * model_.tick_s,
            .outputs_force = true,
            .tells_force_sequence = true};
}

double ModelledTouch::rounded(double metres) const
{
    return model_.count_m > 0.0 ? std::round(metres / model_.count_m) * model_.count_m : metres;
}

void ModelledTouch::move_on(double seconds, const glm::dvec3& wish_m, const glm::dvec3& force_n)
{
    const bool is_held = model_.hand_stiffness > 0.0;
    const double mass = model_.arm_kg + (is_held ? model_.hand_kg : 0.0);
    const double damping = model_.viscous + (is_held ? model_.hand_damping : 0.0);
    while (seconds > 0.0) {
        const double dt = std::min(seconds, STEP_S);
        seconds -= dt;
        const glm::dvec3 pull = force_n + model_.hand_stiffness * (wish_m - position_m_);
        velocity_ = (velocity_ + pull * (dt / mass)) / (1.0 + damping * dt / mass);
        // Friction can stop the arm within the step, but cannot reverse its motion.
        const double speed = glm::length(velocity_), taken = model_.coulomb_n * dt / mass;
        velocity_ = speed > taken ? velocity_ * (1.0 - taken / speed) : glm::dvec3(0.0);
        position_m_ += velocity_ * dt;
        work_j_ += glm::dot(force_n, velocity_) * dt;
    }
}

ReadResult ModelledTouch::read(DeviceState& state) noexcept
{
    wish_.take();
    const HandWish& wish = wish_.value();
    if (wish.jump != jump_) {
        jump_ = wish.jump;
        position_m_ = wish.position_m;
        velocity_ = glm::dvec3(0.0);
        in_flight_.fill({});
    }
    const size_t slots = in_flight_.size();
    const Written applied = in_flight_[(ticks_ + slots - size_t(model_.delay_ticks)) % slots];
    ++ticks_;
    in_flight_[ticks_ % slots] = in_flight_[(ticks_ + slots - 1) % slots];
    const double share = double(random_()) / 4294967296.0;
    const double time_s = double(ticks_) * model_.tick_s + model_.jitter_s * (2.0 * share - 1.0);
    move_on(time_s - time_s_, wish.position_m, applied.force_n);
    time_s_ = time_s;

    state = {};
    state.time_ns = uint64_t(std::llround(time_s * 1e9));
    state.sequence = uint32_t(ticks_);
    state.force_sequence = applied.sequence;
    state.position_m = {rounded(position_m_.x), rounded(position_m_.y), rounded(position_m_.z)};
    state.buttons = wish.buttons;
    state.jump = jump_;
    return ReadResult::fresh;
}

bool ModelledTouch::write(const glm::dvec3& force_n, uint32_t sequence) noexcept
{
    glm::dvec3 force = is_finite(force_n) ? force_n : glm::dvec3(0.0);
    const double length = glm::length(force);
    if (length > model_.peak_n) force *= model_.peak_n / length;
    in_flight_[ticks_ % in_flight_.size()] = {force, sequence};
    return true;
}

}  // namespace shvr
