#pragma once
// Builds the leap grid of shaders/leap.h from the value ranges of the cells: four passes over the cells, run when the
// transfer function, the visible groups or the painted bricks change. Cost: one thread a cell and pass, at most
// 2 * LEAP_LIMIT loads each.

#include <array>
#include <optional>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/leap.h"

namespace shvr {

struct LeapGridInput {
    gpu::OccupancyParams params;
    std::vector<uint32_t> visible_intervals;  ///< engine/scene/transfer_function.h
    std::optional<MaskBinding> mask;
    std::array<uint32_t, 8> visible_groups{};  ///< bit per group; used with a mask
};

/// Returns the new version of `volume.leap`.
Resource leap_grid(FrameGraph& graph, const VolumeBinding& volume, const LeapGridInput& input);

}  // namespace shvr
