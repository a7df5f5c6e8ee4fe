#pragma once
// Builds the leap grid of shaders/leap.h from the value ranges of the cells: four stages over the cells, run when the
// transfer function, the visible groups or the painted bricks change. Cost: one thread a cell and stage, at most
// 2 * LEAP_LIMIT loads each. Each stage is a pass of its own, so that other work gets in between; where only some cells
// changed, the stages cover no more than what those can reach.
//
//   occupancy -> scratch[0] -> distance along x -> scratch[1] -> along y -> scratch[0] -> along z -> leap
//
// A patch is what a picture needs at once after a few cells changed: right, but some leaps are shorter than they could
// be until the four stages have run. One thread a cell, few loads.

#include <array>
#include <optional>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/leap.h"

namespace shvr {

/// Half open.
struct CellBox {
    glm::uvec3 begin{0}, end{0};
    bool empty() const { return glm::any(glm::lessThanEqual(end, begin)); }
    bool operator==(const CellBox&) const = default;
};

struct LeapGridInput {
    gpu::OccupancyParams params;              ///< but for the cells
    CellBox changed;                          ///< cells whose occupancy may have changed
    std::vector<uint32_t> visible_intervals;  ///< engine/look/transfer_function.h
    std::optional<MaskBinding> mask;
    std::array<uint32_t, 8> visible_groups{};  ///< bit per group; used with a mask
};

inline constexpr uint32_t LEAP_STAGES = 4;

/// Adds one stage, 0 ... LEAP_STAGES - 1, and renews the handles of `volume` that it writes. The leap grid holds after
/// the last one, provided that all four ran in order with the same input.
void leap_grid_stage(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input, uint32_t stage);

/// The grid that is there holds for what is now in the changed cells, too.
void leap_grid_patch(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input);

}  // namespace shvr
