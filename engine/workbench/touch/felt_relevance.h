#pragma once
// Passes relevance bits to the servo, and computes them from a volume if no mirror does. Any thread.

#include <bitset>
#include <optional>
#include <vector>

#include "engine/live/relevance_mirror.h"
#include "haptics/relevance.h"

namespace shvr::ui {

/// Writes all of `patch` except sequence, time and settings.
void put_bits(const RelevancePlace& place, const RelevanceBits& bits, RelevancePatch& patch);
void put_mirrored(const MirroredRelevance& mirrored, RelevancePatch& patch);

/// Returns the groups that are felt; without names: all, painted or not.
std::optional<std::bitset<256>> felt_groups(const std::vector<uint8_t>& groups);

/// Computes the relevance around a probe as the window mirrors it. `source` includes density offsets already; `mask`
/// may be null if no groups are named.
void host_relevance(const VolumeSource& source, const Mask* mask, const std::vector<uint8_t>& groups,
                    const RegionWish& wish, double threshold, RelevancePatch& patch);

}  // namespace shvr::ui
