#pragma once
// The look of a scan that is shown for the first time. Pure; any thread.

#include <cstdint>
#include <span>
#include <string>

#include "engine/session/session.h"

namespace shvr {

/// Most voxels of a scan that gets ambient occlusion by itself on a device that is the processor: 512^3 take about 4 s
/// there (shaders/MEASURED.md), in which the picture is shown without, before the sharp one.
inline constexpr int64_t MAX_OCCLUDED_BY_CPU = int64_t{1} << 27;

/// Gives the light of the examples and, to at most `most_occluded` voxels, ambient occlusion. Leaves the light as it is
/// if any of the settings, "KEY=VALUE", states a part of it.
void light_new_scan(Session& session, const Size3& size, int64_t most_occluded, std::span<const std::string> settings);

}  // namespace shvr
