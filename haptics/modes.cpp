#include "haptics/modes.h"

#include <algorithm>

#include "engine/base/finite.h"

namespace shvr {
namespace {

bool is_usable(const RelevancePatch& patch, const ForceSettings& settings, double known_share, uint64_t now_ns)
{
    const bool is_fresh = now_ns <= patch.time_ns || now_ns - patch.time_ns <= RELEVANCE_FRESH_NS;
    return is_fresh && patch.settings == settings.relevance_settings && known_share >= MIN_KNOWN_SHARE;
}

ModePull pull_in(const ForceSettings& settings, const RelevancePatch& patch, const glm::dvec3& probe)
{
    if (patch.sequence == 0) return {};
    const double radius = settings.probe_radius;
    const Proxy proxy = find_proxy(patch, probe, radius, settings.law);
    ModePull pull{.offset = proxy.offset, .in_contact = proxy.in_contact, .relevant_share = proxy.relevant_share};
    if (settings.finds_middle) pull.middle = find_middle(patch, probe, radius, settings.law, proxy);
    return pull;
}

ModePull pull_to_surface(const ForceSettings& settings, const RelevancePatch& patch, const glm::dvec3& probe,
                         SurfaceMemory& surface)
{
    const ProxyLaw law = settings.law == ProxyLaw::thesis ? ProxyLaw::thesis : ProxyLaw::mean;  // only the proxy's
                                                                                                // share is used
    const Proxy around = patch.sequence == 0 ? Proxy{} : find_proxy(patch, probe, settings.probe_radius, law);
    const double hold = std::clamp(settings.surface_share, 0.0, 1.0);
    const bool is_known = patch.known_part(probe, settings.probe_radius).share >= MIN_KNOWN_SHARE;
    const bool is_little = is_known && around.relevant_share < SURFACE_HYSTERESIS * hold;
    if (surface.is_pinned) {
        const double height = glm::dot(probe - surface.pin, settings.to_camera);
        surface.farthest = std::min(surface.farthest, height);
        const bool moves_back = height - surface.farthest > RELEASE_SHARE * settings.probe_radius;
        if (moves_back || is_little) surface.is_pinned = false;
    } else {
        surface.is_armed = surface.is_armed || is_little;
        if (surface.is_armed && is_known && around.relevant_share > hold)
            surface = {.is_pinned = true, .is_armed = false, .pin = probe, .farthest = 0.0};
    }
    ModePull pull{.in_contact = surface.is_pinned, .relevant_share = around.relevant_share};
    if (surface.is_pinned) pull.offset = pull.middle = surface.pin - probe;
    return pull;
}

ModePull pull_to_object(const ForceSettings& settings, const RelevancePatch& patch, const glm::dvec3& probe,
                        uint64_t now_ns, GrowthMemory& growth)
{
    const double radius = settings.probe_radius;
    const bool may_grow = is_finite(probe) && patch.settings == settings.relevance_settings;
    const RelevancePatch& object = may_grow ? advance_object(patch, probe, radius, growth) : growth.object();
    ModePull pull = pull_in(settings, object, probe);
    // If too little of the ball is known, the probe counts as on its object, which the unknown part may contain.
    const RelevancePatch& felt = object.sequence == 0 ? patch : object;
    const bool is_on = pull.in_contact || felt.known_part(probe, radius).share < MIN_KNOWN_SHARE;
    if (may_grow) keep_contact(patch, probe, radius, is_on, now_ns, growth);
    pull.has_lost = growth.contacts > 0 && !is_on;
    pull.object = growth.contacts;
    return pull;
}

}  // namespace

ModePull pull_of(const ForceSettings& settings, const RelevancePatch& patch, const glm::dvec3& probe, uint64_t now_ns,
                 SurfaceMemory& surface, GrowthMemory& growth) noexcept
{
    if (settings.mode != TouchMode::object) forget_object(growth);
    if (settings.mode != TouchMode::surface) surface = {};
    ModePull pull;
    switch (settings.mode) {
        case TouchMode::proximity: pull = pull_in(settings, patch, probe); break;
        case TouchMode::surface: pull = pull_to_surface(settings, patch, probe, surface); break;
        case TouchMode::object: pull = pull_to_object(settings, patch, probe, now_ns, growth); break;
    }
    // A grown object is as old as its patch. Without an object nothing is felt, and the latest patch's age counts.
    const bool is_object = settings.mode == TouchMode::object && growth.has_object;
    const RelevancePatch& felt = is_object ? growth.object() : patch;
    pull.known_share = felt.known_part(probe, settings.probe_radius).share;
    pull.is_usable = is_usable(felt, settings, pull.known_share, now_ns);
    return pull;
}

}  // namespace shvr
