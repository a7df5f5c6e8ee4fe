#pragma once
// Finds the slots of painted bricks when a table of all bricks would be too large. In this hash table, each brick is at
// one of two places (cuckoo hashing, Pagh and Rodler 2004). Kernels always check both places, which takes six loads and
// no loop.

#include <cstdint>
#include <span>
#include <vector>

#include "shaders/bricks.h"

namespace shvr {

struct PaintedBrick {
    glm::uvec3 brick;   ///< position in the mask, in bricks; below 65536 along x and y
    uint32_t slot = 0;  ///< never gpu::NO_SLOT, which marks free entries
};

/// A cuckoo hash table in the layout of shaders/library/mask.glsl: the index of its last entry, then its entries
/// (gpu::MASK_ENTRY). At least half of the entries are free; the table is twice as large if an insertion moves hundreds
/// of bricks without finding a free entry.
std::vector<uint32_t> painted_table(std::span<const PaintedBrick> bricks);

}  // namespace shvr
