#include "haptics/force.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/finite.h"

namespace shvr {
namespace {

constexpr double VELOCITY_CUTOFF_HZ = 100.0;
/// Maximum length of a tick for the fades: a longer pause of the servo counts as this long.
constexpr uint64_t MAX_TICK_NS = 10'000'000;
/// The thesis damps by motion per tick instead of per second. With ticks of this length, both definitions agree.
constexpr double THESIS_TICK_S = 0.001;

bool is_place(const DeviceState& state)
{
    const glm::dquat& q = state.rotation;
    const bool is_near = std::abs(state.position_m.x) <= MAX_REACH_M && std::abs(state.position_m.y) <= MAX_REACH_M &&
                         std::abs(state.position_m.z) <= MAX_REACH_M;  // false for NaN
    return is_near && std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}

bool is_glitch_between(const DeviceState& a, const DeviceState& b)
{
    return glm::distance(a.position_m, b.position_m) > GLITCH_M;
}

void disengage(ForceMemory& memory)
{
    memory.has_begun = false;
    memory.engagement = 0.0;
    memory.energy = {};
}

/// Clears a fault after the user switched assistance on again. The numbering of forces continues, and the heat of the
/// motors is kept.
void clear_fault(uint32_t reset, ForceMemory& memory)
{
    if (memory.reset == reset) return;
    if (memory.flags & FORCE_FAULT) {
        ForceMemory fresh;
        fresh.sent = memory.sent;
        fresh.heat = memory.heat;
        fresh.last_tick_ns = memory.last_tick_ns;
        memory = fresh;
    }
    memory.reset = reset;
}

/// Gives zero force from this tick on, without the limit on the force's change per tick.
ForceStep stop(const ForceSettings& settings, uint32_t flags, uint64_t now_ns, ForceMemory& memory)
{
    memory.flags = (memory.flags & FORCE_FAULT) | flags;
    memory.has_last = false;
    memory.glitches = 0;
    memory.velocity = memory.moved_m = glm::dvec3(0.0);
    memory.force_n = memory.spring_n = memory.crossed_n = glm::dvec3(0.0);
    memory.contact_fade = 0.0;
    memory.cross = 1.0;
    memory.rate = {};
    memory.surface = {};
    memory.click = {};
    disengage(memory);
    add_sent(memory.force_n, now_ns, memory.sent);
    const glm::dvec3 place = settings.workspace.to_point(memory.last.position_m);
    const glm::dvec3 probe = is_finite(place) ? place : glm::dvec3(0.0);
    return {.probe = probe, .proxy = probe, .middle = probe, .flags = memory.flags, .sequence = memory.sent.sequence};
}

void accept_elsewhere(const DeviceState& state, ForceMemory& memory)
{
    memory.has_last = true;
    memory.last = state;
    memory.glitches = 0;
    memory.velocity = memory.moved_m = glm::dvec3(0.0);
    disengage(memory);
}

/// Accepts the next state. A constant velocity yields its exact value at any tick rate, so damping is the same, too.
void accept_next(const DeviceState& state, ForceMemory& memory)
{
    // If the device's clock stands still or goes back, the velocity is left unchanged.
    const auto nanoseconds = int64_t(state.time_ns - memory.last.time_ns);
    if (nanoseconds > 0) {
        const double dt = double(nanoseconds) * 1e-9;
        const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * VELOCITY_CUTOFF_HZ * dt);
        memory.velocity += share * ((state.position_m - memory.last.position_m) / dt - memory.velocity);
    }
    memory.moved_m = state.position_m - memory.last.position_m;
    memory.last = state;
    memory.glitches = 0;
}

void believe_or_not(const DeviceState& state, ForceMemory& memory)
{
    if (!memory.has_last || state.jump != memory.last.jump) return accept_elsewhere(state, memory);
    if (!is_glitch_between(state, memory.last)) return accept_next(state, memory);
    const bool is_near_candidate = memory.glitches > 0 && !is_glitch_between(state, memory.candidate);
    memory.glitches = is_near_candidate ? memory.glitches + 1 : 1;
    memory.candidate = state;
    if (memory.glitches >= GLITCHES_TO_ACCEPT) accept_elsewhere(state, memory);
}

/// Returns `value` after a linear fade for `dt_ns`: towards 1 if `rises`, else towards 0. A full fade takes `whole_ns`.
double faded(double value, bool rises, uint64_t dt_ns, uint64_t whole_ns)
{
    const double change = double(dt_ns) / double(whole_ns);
    return std::clamp(value + (rises ? change : -change), 0.0, 1.0);
}

double share_of_one(double value)
{
    return value > 0.0 ? std::min(value, 1.0) : 0.0;  // 0 for NaN
}

glm::dvec3 shortened(const glm::dvec3& v, double most)
{
    const double length = glm::length(v);
    return length > most ? v * (most / length) : v;
}

/// Returns the divisor of eq. 3.7: the probe's size in the hand times the user's scale of its motion.
double scaling(const ForceSettings& settings)
{
    const double in_hand_m = settings.probe_radius / settings.workspace.scale();
    return in_hand_m / PROBE_M * settings.movement_scale;
}

/// Returns the proxy's pull in the device's frame: `to_volume` is a rotation times a scale, so its inverse is its
/// transpose divided by the scale squared.
glm::dvec3 spring(const ForceSettings& settings, double stiffness, const glm::dvec3& offset)
{
    const double scale = settings.workspace.scale();
    if (!(scale > 0.0)) return glm::dvec3(0.0);
    return stiffness * (glm::transpose(settings.workspace.to_volume) * offset) / (scale * scale);
}

struct Moment {
    uint64_t now_ns = 0, dt_ns = 0;
    bool is_fresh = false;
};

/// Cross-fades from the previous pull to the present one after a change of mode, law, object or limits: no sudden step.
glm::dvec3 cross_faded(const ForceSettings& settings, const ModePull& pull, uint32_t limits, const glm::dvec3& wanted,
                       uint64_t dt_ns, ForceMemory& memory)
{
    if (settings.mode != memory.mode || settings.law != memory.law || pull.object != memory.object ||
        limits != memory.limits) {
        memory.mode = settings.mode;
        memory.law = settings.law;
        memory.object = pull.object;
        memory.limits = limits;
        memory.cross = 0.0;
        memory.crossed_n = memory.spring_n;
    }
    memory.cross = faded(memory.cross, true, dt_ns, MODE_FADE_NS);
    memory.spring_n = memory.cross * wanted + (1.0 - memory.cross) * memory.crossed_n;
    return memory.spring_n;
}

glm::dvec3 damping_of(const ForceSettings& settings, const ForceMemory& memory)
{
    const double damping = memory.contact_fade * std::clamp(settings.damping, 0.0, MAX_DAMPING);
    if (settings.law != ProxyLaw::thesis) return damping * memory.velocity;
    const double divided = std::max(scaling(settings), 1.0);  // never stronger than is stable
    return damping / divided * memory.moved_m / THESIS_TICK_S;
}

/// Returns the force of a click, before fades.
glm::dvec3 click_of(const ForceSettings& settings, const DeviceCaps& caps, const ModePull& pull, uint64_t dt_ns,
                    ForceMemory& memory)
{
    ClickMemory& click = memory.click;
    const double speed = glm::length(memory.velocity);
    const bool begins = pull.in_contact && click.off_ns >= CLICK_PAUSE_NS && speed >= CLICK_LEAST_SPEED;
    if (pull.in_contact)
        click.off_ns = 0;
    else if (pull.is_usable)  // unusable relevance is no proof of a missing contact
        click.off_ns = std::min(click.off_ns + dt_ns, CLICK_PAUSE_NS);
    if (!settings.clicks || !caps.outputs_force) {
        click.left_ns = 0;
        return glm::dvec3(0.0);
    }
    click.left_ns -= std::min(click.left_ns, dt_ns);
    if (begins) {
        click.left_ns = CLICK_NS;
        click.peak_n = -CLICK_N * std::min(speed / CLICK_FULL_SPEED, 1.0) * memory.velocity / speed;
    }
    if (click.left_ns == 0) return glm::dvec3(0.0);
    return std::sin(std::numbers::pi * double(CLICK_NS - click.left_ns) / double(CLICK_NS)) * click.peak_n;
}

/// Returns the sum of spring, click and damping forces, after fades and before limits.
ForceStep feel(const ForceSettings& settings, const DeviceCaps& caps, const RelevancePatch& patch, const Moment& moment,
               ForceMemory& memory, GrowthMemory& growth)
{
    const glm::dvec3 probe = settings.workspace.to_point(memory.last.position_m);
    const ModePull pull = pull_of(settings, patch, probe, moment.now_ns, memory.surface, growth);
    const double rate_share = caps.outputs_force ? share_for_rate(moment.now_ns, memory.rate) : 1.0;
    const double stiffness = rate_share * stiffness_at_hand(settings, caps, memory.sent);
    const glm::dvec3 wanted = spring(settings, stiffness, pull.offset);

    // An unknown force cannot count as small.
    const bool is_known = pull.is_usable && pull.known_share == 1.0;
    const bool may_begin = !caps.outputs_force || (is_known && glm::length(wanted) < ENGAGE_BELOW_N);
    memory.has_begun = memory.has_begun || may_begin;
    if (rate_share == 0.0) disengage(memory);
    const uint64_t engage_ns = caps.outputs_force ? ENGAGE_NS : ENGAGE_SIMULATED_NS;
    if (memory.has_begun) memory.engagement = faded(memory.engagement, true, moment.dt_ns, engage_ns);
    memory.relevance_fade = faded(memory.relevance_fade, pull.is_usable, moment.dt_ns, RELEVANCE_FADE_NS);
    memory.contact_fade = faded(memory.contact_fade, pull.in_contact, moment.dt_ns, CONTACT_FADE_NS);
    const double box = share_in_box(caps, memory.last.position_m);
    if (!pull.is_usable) memory.flags |= FORCE_NO_REGION;
    if (memory.engagement < 1.0) memory.flags |= FORCE_ENGAGING;
    if (rate_share < 1.0) memory.flags |= FORCE_SLOW;
    if (box < 1.0) memory.flags |= FORCE_OUTSIDE;
    if (pull.has_lost) memory.flags |= FORCE_OFF_OBJECT;

    const double fade = box * memory.strength * memory.engagement * memory.relevance_fade;
    const glm::dvec3 pulled = fade * cross_faded(settings, pull, patch.limits, wanted, moment.dt_ns, memory);
    if (caps.outputs_force && moment.is_fresh) {
        const SentForce effect = force_in_effect(caps, memory.last, moment.now_ns, memory.sent);
        observe_energy(memory.last.position_m, pulled, effect.force_n, memory.energy);
    }
    if (memory.contact_fade == 0.0) memory.energy.made_j = 0.0;  // no contact: nothing to dissipate
    const glm::dvec3 taken = take_energy(memory.velocity, double(moment.dt_ns) * 1e-9, memory.energy);
    const glm::dvec3 driven = pulled + fade * click_of(settings, caps, pull, moment.dt_ns, memory);
    return {.force_n = driven - fade * rate_share * damping_of(settings, memory) + memory.engagement * taken,
            .probe = probe,
            .proxy = probe + pull.offset,
            .middle = probe + pull.middle,
            .in_contact = pull.in_contact,
            .relevant_share = pull.relevant_share,
            .objects = growth.contacts};
}

/// Returns the maximum change of the force in a tick. The limit grows with the hand's speed, so that a slow hand feels
/// no jolt where the force law is steep: 1200 N/m over two voxels where the ball meets a thin sheet.
double slew_at(const glm::dvec3& velocity)
{
    return std::clamp(GENTLE_SLEW_N * glm::length(velocity) / GENTLE_SPEED, GENTLE_SLEW_N, SLEW_N);
}

/// Limits the force to two balls: one around 0, and one around the last force; the latter's centre is in the first.
void limit(const DeviceCaps& caps, const glm::dvec3& wanted, ForceMemory& memory)
{
    const double held = caps.outputs_force ? force_allowed(caps, memory.heat) : caps.peak_force_n;
    const double most = std::min(held, caps.peak_force_n);
    const glm::dvec3 target = shortened(wanted, most);
    if (glm::length(wanted) > caps.peak_force_n) memory.flags |= FORCE_CLAMPED;
    if (most < caps.peak_force_n && glm::length(wanted) > most) memory.flags |= FORCE_WARM;
    memory.force_n = shortened(memory.force_n + shortened(target - memory.force_n, slew_at(memory.velocity)), most);
}

}  // namespace

double stiffness_at_hand(const ForceSettings& settings, const DeviceCaps& caps, const SentForces& sent)
{
    const double stiffness = settings.stiffness / scaling(settings);
    return stiffness > 0.0 ? std::min(stiffness, stable_stiffness(caps, sent)) : 0.0;  // 0 for NaN
}

ForceStep step(const ForceSettings& settings, const DeviceCaps& stated, ReadResult result, const DeviceState& state,
               const RelevancePatch& patch, uint64_t now_ns, ForceMemory& memory, GrowthMemory& growth) noexcept
{
    const DeviceCaps caps = sane(stated);
    clear_fault(settings.reset, memory);
    const uint64_t dt_ns = memory.last_tick_ns == 0 || now_ns < memory.last_tick_ns
                               ? 0
                               : std::min(now_ns - memory.last_tick_ns, MAX_TICK_NS);
    const double dt_s = double(dt_ns) * 1e-9;
    memory.last_tick_ns = now_ns;
    add_heat(memory.force_n, dt_s, memory.heat);  // the force of the last tick, which has been in effect since

    // ---- The hand's position ----
    if (result == ReadResult::lost) return stop(settings, FORCE_NO_DEVICE, now_ns, memory);
    if (result == ReadResult::fresh) {
        if (!is_place(state)) memory.flags |= FORCE_FAULT;
        if (!(memory.flags & FORCE_FAULT)) {
            believe_or_not(state, memory);
            measure_latency(caps, state, now_ns, dt_s, memory.sent);
            add_state(now_ns, memory.rate);
        }
        memory.last_fresh_ns = now_ns;
    }
    if (memory.flags & FORCE_FAULT) return stop(settings, 0, now_ns, memory);
    if (!memory.has_last) return stop(settings, FORCE_NO_DEVICE, now_ns, memory);
    if (settings.let_go) return stop(settings, FORCE_LET_GO, now_ns, memory);

    // ---- The force it should feel ----
    memory.flags = 0;
    const bool is_there = memory.last.calibrated && now_ns - memory.last_fresh_ns <= SILENCE_NS;
    const double strength = share_of_one(settings.strength);
    const double change = memory.engagement > 0.0 ? double(dt_ns) / double(STRENGTH_FADE_NS) : 1.0;
    memory.strength += std::clamp(strength - memory.strength, -change, change);
    ForceStep now;
    now.probe = now.proxy = now.middle = settings.workspace.to_point(memory.last.position_m);
    if (is_there && settings.assistance) {
        const bool is_fresh = result == ReadResult::fresh && memory.glitches == 0;
        now = feel(settings, caps, patch, {now_ns, dt_ns, is_fresh}, memory, growth);
    } else {
        disengage(memory);
        forget_object(growth);
        memory.surface = {};
        memory.click = {};
        memory.contact_fade = 0.0;
    }
    if (!is_there) memory.flags |= FORCE_NO_DEVICE;

    limit(caps, now.force_n, memory);
    if (!is_finite(memory.force_n) || !is_finite(now.proxy)) {
        memory.flags |= FORCE_FAULT;  // non-finite settings
        return stop(settings, 0, now_ns, memory);
    }
    add_sent(memory.force_n, now_ns, memory.sent);
    now.force_n = memory.force_n;
    now.flags = memory.flags;
    now.sequence = memory.sent.sequence;
    now.made_j = memory.energy.made_j;
    now.latency_s = memory.sent.latency_s;
    const glm::dvec3 velocity = settings.workspace.to_volume * memory.velocity;
    if (is_finite(velocity)) now.velocity = velocity;
    return now;
}

}  // namespace shvr
