#include "engine/workbench/touch/stylus_player.h"

#include <utility>

#include "engine/base/error.h"
#include "engine/workbench/touch/felt_relevance.h"

namespace shvr::ui {

GuideSettings guide_settings(const Session& session, double probe_radius, FeltLimits limits)
{
    const ProbeSettings& probe = session.probe;
    return {.assists = probe.guided,
            .law = probe.guidance,
            .mode = probe.touch.mode,
            .threshold = probe.haptic_threshold.value_or(0.0),
            .probe_radius = probe_radius,
            .feel = probe.touch,
            .limits = std::move(limits)};
}

std::vector<StylusPoint> play_stylus(const Trace& trace, const GuideSettings& guide, bool by_hand,
                                     std::shared_ptr<const VolumeSource> source, const Mask& mask)
{
    const std::string& unit = source->info().unit;
    if (!trace.unit.empty() && trace.unit != unit)
        fail("the recording: its lengths are in '", trace.unit, "', and those of this scan in '", unit,
             "'; expected a recording of this scan");
    Trace led = trace;
    for (TraceSettings& settings : led.settings) {
        settings.threshold = guide.threshold;
        ForceSettings& force = settings.force;
        force.assistance = guide.assists;
        force.law = guide.law;
        force.mode = guide.mode;
        force.probe_radius = guide.probe_radius;
        force.stiffness = guide.feel.stiffness;
        force.damping = guide.feel.damping;
        force.surface_share = guide.feel.surface_share;
        force.strength = guide.feel.strength;
        force.let_go = false;
        force.finds_middle = guide.feel.at_proxy;
    }
    ReplayOptions how;
    how.relevance_anew = true;  // computes relevance from the present threshold, groups and voxels
    if (by_hand) how.touch = TouchModel{};
    const FeltLimits limits = trace.feels_seen ? guide.limits : limits_of_groups(guide.feel.groups);
    const MakeRelevance make = [&](const RegionWish& wish, double threshold, RelevancePatch& patch) {
        host_relevance(*source, &mask, limits, wish, threshold, patch);
    };
    const ReplayResult result = replay_trace(led, how, make, true);
    std::vector<StylusPoint> points;
    points.reserve(result.steps.size());
    for (size_t i = 0; i < result.steps.size(); ++i) {
        const ForceStep& step = result.steps[i];
        points.push_back({.probe = step.probe,
                          .middle = step.in_contact ? step.middle : step.probe,
                          .in_contact = step.in_contact,
                          .relevant_share = step.relevant_share,
                          .is_pressed = (led.ticks[i].state.buttons & PAINT_BUTTON) != 0});
    }
    return points;
}

}  // namespace shvr::ui
