#pragma once
// Hands bits of what is relevant over to the servo, and makes them from a volume where no mirror does. Any thread.

#include <bitset>
#include <optional>
#include <vector>

#include "engine/live/relevance_mirror.h"
#include "haptics/relevance.h"

namespace shvr::ui {

/// All of `patch` but sequence, time and settings.
void put_bits(const RelevancePlace& place, const RelevanceBits& bits, RelevancePatch& patch);
void put_mirrored(const MirroredRelevance& mirrored, RelevancePatch& patch);

/// Groups that are felt; none named: all, painted or not.
std::optional<std::bitset<256>> felt_groups(const std::vector<uint8_t>& groups);

/// What is relevant around a point, as the window mirrors it. `source` holds density offsets already; `mask` may be
/// null where no groups are named.
void host_relevance(const VolumeSource& source, const Mask* mask, const std::vector<uint8_t>& groups,
                    const glm::dvec3& point, double radius, double threshold, RelevancePatch& patch);

}  // namespace shvr::ui
