#include "engine/workbench/touch/felt_relevance.h"

#include <algorithm>

namespace shvr::ui {

void put_bits(const RelevancePlace& place, const RelevanceBits& bits, RelevancePatch& patch)
{
    patch.origin = glm::ivec3(bits.box.lower);
    patch.size = glm::ivec3(bits.box.size());
    patch.words_per_row = int32_t(bits.words_per_row);
    patch.spacing = place.spacing;
    patch.volume_size = glm::ivec3(place.level_size);
    patch.level = place.level;
    std::ranges::copy(bits.words, patch.words.begin());
}

void put_mirrored(const MirroredRelevance& mirrored, RelevancePatch& patch)
{
    put_bits(mirrored.place, mirrored.bits, patch);
    patch.sequence = mirrored.sequence;
    patch.time_ns = mirrored.true_at_ns;
    patch.settings = mirrored.settings;
    patch.limits = mirrored.limits;
}

FeltLimits felt_limits(const Session& session, const Camera& camera, const VolumeInfo& volume,
                       const IntensityWindow& window)
{
    const ProbeSettings& probe = session.probe;
    FeltLimits limits = limits_of_groups(probe.touch.groups);
    if (!probe.touch.feels_hidden)
        limit_to_seen(session.look(), camera, volume, window, probe.haptic_threshold.value_or(0.0), limits);
    return limits;
}

void host_relevance(const VolumeSource& source, const Mask* mask, const FeltLimits& limits, const RegionWish& wish,
                    double threshold, RelevancePatch& patch)
{
    const RelevancePlace place = relevance_place(source, wish);
    RelevanceBits bits = relevance_on_host(source, place.level, place.box, threshold, limits, mask);
    apply_limits(limits, source.info().spacing, mask, bits);
    put_bits(place, bits, patch);
}

}  // namespace shvr::ui
