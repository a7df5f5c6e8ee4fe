#include "haptics/force.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shvr {
namespace {

constexpr double VELOCITY_CUTOFF_HZ = 100.0;
/// Fades treat a longer pause of the servo as one of this length.
constexpr uint64_t LONGEST_TICK_NS = 10'000'000;

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
}

/// No force from this tick on, ignoring the limit on its change.
ForceStep stop(const ForceSettings& settings, ForceMemory& memory, uint32_t flags)
{
    memory.flags = (memory.flags & FORCE_FAULT) | flags;
    memory.has_last = false;
    memory.glitches = 0;
    memory.velocity = glm::dvec3(0.0);
    memory.force_n = glm::dvec3(0.0);
    memory.contact_fade = 0.0;
    disengage(memory);
    const glm::dvec3 place = settings.workspace.to_point(memory.last.position_m);
    const glm::dvec3 probe = is_finite(place) ? place : glm::dvec3(0.0);
    return {.probe = probe, .proxy = probe, .flags = memory.flags};
}

void accept_elsewhere(const DeviceState& state, ForceMemory& memory)
{
    memory.has_last = true;
    memory.last = state;
    memory.glitches = 0;
    memory.velocity = glm::dvec3(0.0);
    disengage(memory);
}

/// Exact for a constant velocity over the interval, so that damping does not depend on the rate.
void accept_next(const DeviceState& state, ForceMemory& memory)
{
    // If the device's clock stands still or goes back, the velocity is left as it was.
    const auto nanoseconds = int64_t(state.time_ns - memory.last.time_ns);
    if (nanoseconds > 0) {
        const double dt = double(nanoseconds) * 1e-9;
        const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * VELOCITY_CUTOFF_HZ * dt);
        memory.velocity += share * ((state.position_m - memory.last.position_m) / dt - memory.velocity);
    }
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

/// `value` after `dt_ns` of a fade towards 0 or 1 that takes `whole_ns` in full.
double faded(double value, bool rises, uint64_t dt_ns, uint64_t whole_ns)
{
    const double change = double(dt_ns) / double(whole_ns);
    return std::clamp(value + (rises ? change : -change), 0.0, 1.0);
}

glm::dvec3 shortened(const glm::dvec3& v, double most)
{
    const double length = glm::length(v);
    return length > most ? v * (most / length) : v;
}

/// The proxy's pull in the device's frame: `to_volume` is a rotation times a scale, so its inverse is its transpose
/// divided by the scale squared.
glm::dvec3 spring(const ForceSettings& settings, const DeviceCaps& caps, const glm::dvec3& offset)
{
    const double scale = settings.workspace.scale();
    if (!(scale > 0.0)) return glm::dvec3(0.0);
    const double stiffness = std::clamp(settings.stiffness, 0.0, caps.stiffness_limit);
    return stiffness * (glm::transpose(settings.workspace.to_volume) * offset) / (scale * scale);
}

bool is_usable(const RelevancePatch& patch, const glm::dvec3& probe, double radius, uint64_t now_ns)
{
    const bool is_fresh = now_ns <= patch.time_ns || now_ns - patch.time_ns <= RELEVANCE_FRESH_NS;
    return patch.sequence != 0 && is_fresh && patch.covers(probe, radius);
}

struct Moment {
    uint64_t now_ns = 0, dt_ns = 0;
};

/// Spring and damping, faded, before the limits.
ForceStep feel(const ForceSettings& settings, const DeviceCaps& caps, const RelevancePatch& patch, const Moment& moment,
               ForceMemory& memory)
{
    const glm::dvec3 probe = settings.workspace.to_point(memory.last.position_m);
    const bool usable = is_usable(patch, probe, settings.probe_radius, moment.now_ns);
    const Proxy proxy = patch.sequence == 0 ? Proxy{} : find_proxy(patch, probe, settings.probe_radius, settings.law);
    const glm::dvec3 pull = spring(settings, caps, proxy.offset);

    // An unknown force cannot count as small.
    const bool may_begin = !caps.outputs_force || (usable && glm::length(pull) < ENGAGE_BELOW_N);
    memory.has_begun = memory.has_begun || may_begin;
    const uint64_t engage_ns = caps.outputs_force ? ENGAGE_NS : ENGAGE_SIMULATED_NS;
    if (memory.has_begun) memory.engagement = faded(memory.engagement, true, moment.dt_ns, engage_ns);
    memory.relevance_fade = faded(memory.relevance_fade, usable, moment.dt_ns, RELEVANCE_FADE_NS);
    memory.contact_fade = faded(memory.contact_fade, proxy.in_contact, moment.dt_ns, CONTACT_FADE_NS);
    if (!usable) memory.flags |= FORCE_NO_REGION;
    if (memory.engagement < 1.0) memory.flags |= FORCE_ENGAGING;

    const double damping = memory.contact_fade * std::clamp(settings.damping, 0.0, MAX_DAMPING);
    return {.force_n = memory.engagement * memory.relevance_fade * (pull - damping * memory.velocity),
            .probe = probe,
            .proxy = probe + proxy.offset,
            .in_contact = proxy.in_contact,
            .relevant_share = proxy.relevant_share};
}

}  // namespace

ForceStep step(const ForceSettings& settings, const DeviceCaps& caps, ReadResult result, const DeviceState& state,
               const RelevancePatch& patch, uint64_t now_ns, ForceMemory& memory) noexcept
{
    const uint64_t dt_ns = memory.last_tick_ns == 0 || now_ns < memory.last_tick_ns
                               ? 0
                               : std::min(now_ns - memory.last_tick_ns, LONGEST_TICK_NS);
    memory.last_tick_ns = now_ns;

    // ---- The hand's position ----
    if (result == ReadResult::lost) return stop(settings, memory, FORCE_NO_DEVICE);
    if (result == ReadResult::fresh) {
        if (!is_place(state)) memory.flags |= FORCE_FAULT;
        if (!(memory.flags & FORCE_FAULT)) believe_or_not(state, memory);
        memory.last_fresh_ns = now_ns;
    }
    if (memory.flags & FORCE_FAULT) return stop(settings, memory, 0);
    if (!memory.has_last) return stop(settings, memory, FORCE_NO_DEVICE);

    // ---- The force it should feel ----
    memory.flags = 0;
    const bool is_there = memory.last.calibrated && now_ns - memory.last_fresh_ns <= SILENCE_NS;
    ForceStep now;
    now.probe = now.proxy = settings.workspace.to_point(memory.last.position_m);
    if (is_there && settings.assistance) {
        now = feel(settings, caps, patch, {now_ns, dt_ns}, memory);
    } else {
        disengage(memory);
        memory.contact_fade = 0.0;
    }
    if (!is_there) memory.flags |= FORCE_NO_DEVICE;

    // ---- The limits: a ball around 0, and a ball around the last force, whose centre lies in the first ----
    const glm::dvec3 wanted = now.force_n;
    const glm::dvec3 target = shortened(wanted, caps.peak_force_n);
    if (glm::length(wanted) > caps.peak_force_n) memory.flags |= FORCE_CLAMPED;
    memory.force_n = shortened(memory.force_n + shortened(target - memory.force_n, SLEW_N), caps.peak_force_n);
    if (!is_finite(memory.force_n) || !is_finite(now.proxy)) {
        memory.flags |= FORCE_FAULT;  // non-finite settings
        return stop(settings, memory, 0);
    }
    now.force_n = memory.force_n;
    now.flags = memory.flags;
    return now;
}

}  // namespace shvr
