#pragma once
// The handles of a volume on the device, as passes take them.

#include <array>

#include "engine/graph/frame_graph.h"

namespace shvr {

struct VolumeBinding {
    Resource atlas;                        ///< bricks with their aprons: see `filtered`
    Resource page_table;                   ///< uint per brick: slot
    Resource cell_ranges;                  ///< r32ui per cell: minimum | maximum << 16
    Resource leap;                         ///< r32ui per cell, see shaders/leap.h
    std::array<Resource, 2> leap_scratch;  ///< what its stages hand on
    glm::uvec3 brick_counts{1};
    glm::uvec3 cell_counts{1};
    /// false: r32ui, two 16-bit codes along x in one texel, for exact sampling; true: R16_UNORM for the device's filter.
    bool filtered = false;
};

/// The painted voxels on the device; absent while nothing is painted.
struct MaskBinding {
    Resource mask;        ///< r8ui, bricks without aprons
    Resource mask_table;  ///< uint per brick: slot + 1, 0 = unpainted
    glm::uvec3 slots{1};
};

}  // namespace shvr
