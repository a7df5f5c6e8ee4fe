#pragma once
// The look of a scan that is shown for the first time. Pure; any thread.

#include <cstdint>
#include <span>
#include <string>

#include "engine/session/session.h"

namespace shvr {

/// Most voxels of a scan that gets ambient occlusion by itself on a device that is the processor. On two cores with
/// lavapipe, tubes of 1024^3 were sharp 17 s after the start with and without it, dense fog of 1024^3 after 93 instead
/// of 36 s; the picture without occlusion is shown meanwhile.
inline constexpr int64_t MAX_OCCLUDED_BY_CPU = int64_t{1} << 30;

/// Gives the light of the examples and, to at most `most_occluded` voxels, ambient occlusion. Leaves the light as it is
/// if any of the settings, "KEY=VALUE", states a part of it.
void light_new_scan(Session& session, const Size3& size, int64_t most_occluded, std::span<const std::string> settings);

}  // namespace shvr
