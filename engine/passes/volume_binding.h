#pragma once
// The handles of a volume on the device, as passes use them.

#include <array>
#include <optional>

#include "engine/graph/frame_graph.h"

namespace shvr {

/// Handles of paged bricks (shaders/pages.h).
struct PageBinding {
    Resource directory;
    Resource cell_leap;     ///< r8ui per cell of every slot
    Resource reached;       ///< bit per entry: where rays mark the bricks that they visit
    bool feedback = false;  ///< whether rays mark them
    glm::uvec3 counts{1};
    uint32_t cell_shift = 0;
    uint32_t depth = 0;
};

struct VolumeBinding {
    Resource atlas;        ///< bricks with their aprons: see `filtered`
    Resource cell_ranges;  ///< r32ui per cell of the volume, or of every slot: minimum | maximum << 16
    // Resident volumes:
    Resource page_table;                   ///< uint per brick: slot
    Resource leap;                         ///< r32ui per cell, see shaders/leap.h
    std::array<Resource, 2> leap_scratch;  ///< intermediate results of its stages
    std::optional<Resource> sample_bits;   ///< r32ui, two per cell, see shaders/leap.h; of exact texels, where wanted
    // Paged volumes:
    std::optional<PageBinding> pages;
    glm::uvec3 brick_counts{1};
    glm::uvec3 cell_counts{1};
    /// false: r32ui, two 16-bit codes along x in one texel, for exact sampling; true: R16_UNORM for the device's
    /// filter.
    bool filtered = false;
};

/// The bricks of a region of level 0, and their slots.
struct RegionBricks {
    glm::uvec3 begin{0}, counts{1};
    std::vector<uint32_t> slots;  ///< x fastest
};

/// The painted voxels on the device; absent while nothing is painted.
struct MaskBinding {
    Resource mask;        ///< r8ui, bricks without aprons
    Resource mask_table;  ///< slots of painted bricks, see shaders/library/mask.glsl
};

}  // namespace shvr
