#include "ui/workbench/touch/stylus_player.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/live/relevance_host.h"
#include "ui/workbench/touch/stylus_motion.h"

namespace shvr::ui {

GuideSettings guide_settings(const Session& session, double probe_radius)
{
    const ProbeSettings& probe = session.probe;
    return {.assists = probe.guided,
            .law = probe.guidance == Guidance::potential ? ProxyLaw::potential
                   : probe.guidance == Guidance::mean    ? ProxyLaw::mean
                                                         : ProxyLaw::thesis,
            .mode = probe.touch.mode == TouchMode::proximity ? HapticMode::proximity
                    : probe.touch.mode == TouchMode::surface ? HapticMode::surface
                                                             : HapticMode::object,
            .threshold = probe.haptic_threshold.value_or(0.0),
            .probe_radius = probe_radius,
            .feel = probe.touch};
}

void host_relevance(const VolumeSource& source, const Mask& mask, const std::vector<uint8_t>& groups,
                    const glm::dvec3& point, double radius, double threshold, RelevancePatch& patch)
{
    constexpr double SMALL = 24.0, LARGEST = 48.0;  // radii, voxels, that leave the hand some way to go
    const VolumeInfo& info = source.info();
    const double finest = std::min({info.spacing.x, info.spacing.y, info.spacing.z});
    int level = 0;
    while (level + 1 < source.levels() && radius / std::ldexp(finest, level) > LARGEST) ++level;
    const glm::dvec3 spacing = info.spacing * std::ldexp(1.0, level);
    const Size3 size = size_of_level(info.size, level);
    const int64_t side = radius / std::ldexp(finest, level) > SMALL ? 128 : 64;
    RelevanceBits bits = relevance_on_host(source, level, relevance_cube(point / spacing, size, side), threshold);
    if (level == 0) keep_felt_groups(bits.words, bits.box, bits.words_per_row, mask, groups);
    patch.origin = glm::ivec3(bits.box.lower);
    patch.size = glm::ivec3(bits.box.size());
    patch.words_per_row = int32_t(bits.words_per_row);
    patch.spacing = spacing;
    patch.volume_size = glm::ivec3(size);
    patch.level = level;
    std::ranges::copy(bits.words, patch.words.begin());
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
    }
    constexpr uint32_t RELEVANCE_EVERY = 16;  // ticks, as often as a window mirrors it
    ReplayOptions how;
    how.relevance_every = RELEVANCE_EVERY;
    if (by_hand) how.touch = TouchModel{};
    const MakeRelevance make = [&](const glm::dvec3& point, double radius, double threshold, RelevancePatch& patch) {
        host_relevance(*source, mask, guide.feel.groups, point, radius, threshold, patch);
    };
    const ReplayResult result = replay_trace(led, how, make, true);
    std::vector<StylusPoint> points;
    points.reserve(result.steps.size());
    for (size_t i = 0; i < result.steps.size(); ++i) {
        const ForceStep& step = result.steps[i];
        points.push_back({.probe = step.probe,
                          .proxy = step.in_contact ? step.proxy : step.probe,
                          .in_contact = step.in_contact,
                          .relevant_share = step.relevant_share,
                          .is_pressed = (led.ticks[i].state.buttons & PAINT_BUTTON) != 0});
    }
    return points;
}

}  // namespace shvr::ui
