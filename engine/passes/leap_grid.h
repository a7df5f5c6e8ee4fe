#pragma once
// Builds the leap grid of shaders/leap.h from the value ranges of the cells: four stages over the cells, run when the
// transfer function, the visible groups or the painted bricks change. Cost: one thread per word of four cells and
// stage, with at most 2 * LEAP_LIMIT loads per thread. Each stage is a separate pass, so that other work can run
// between stages. If only some cells changed, each stage covers only the cells that the change can affect.
//
//   occupancy -> scratch[0] -> distance along x -> scratch[1] -> along y -> scratch[0] -> along z -> leap
//
// If the volume has room for sample bits, they are computed after the last stage and after every patch. This takes at
// most 84 loads per cell.
//
// After a few cells have changed, a patch makes the grid correct at once, but some leaps stay shorter than necessary
// until the four stages have run. A patch takes one thread per cell and few loads per thread.

#include <array>
#include <optional>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/leap.h"

namespace shvr {

/// A half-open box of cells.
struct CellBox {
    glm::uvec3 begin{0}, end{0};
    bool empty() const { return glm::any(glm::lessThanEqual(end, begin)); }
    bool operator==(const CellBox&) const = default;
};

struct LeapGridInput {
    gpu::OccupancyParams params;              ///< complete except for the cells
    CellBox changed;                          ///< cells whose occupancy may have changed
    std::vector<uint32_t> visible_intervals;  ///< engine/look/transfer_function.h
    std::optional<MaskBinding> mask;
    std::array<uint32_t, 8> visible_groups{};  ///< bit per group; used with a mask
};

inline constexpr uint32_t LEAP_STAGES = 4;

/// Adds stage 0 ... LEAP_STAGES - 1, and updates the handles of `volume` that the stage writes. The leap grid and the
/// sample bits are valid after the last stage, provided all stages ran in order with the same input.
void leap_grid_stage(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input, uint32_t stage);

/// Updates the grid around the changed cells so that no leap is too long for their new contents.
void leap_grid_patch(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input);

}  // namespace shvr
