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
}

std::optional<std::bitset<256>> felt_groups(const std::vector<uint8_t>& groups)
{
    if (groups.empty()) return std::nullopt;
    std::bitset<256> set;
    for (const uint8_t group : groups) set.set(group);
    return set;
}

void host_relevance(const VolumeSource& source, const Mask* mask, const std::vector<uint8_t>& groups,
                    const RegionWish& wish, double threshold, RelevancePatch& patch)
{
    const RelevancePlace place = relevance_place(source, wish);
    RelevanceBits bits = relevance_on_host(source, place.level, place.box, threshold);
    if (const auto felt = felt_groups(groups); felt && mask) limit_to_groups(*mask, *felt, bits);
    put_bits(place, bits, patch);
}

}  // namespace shvr::ui
