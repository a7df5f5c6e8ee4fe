#pragma once
// The voxels that a brush would change if it painted now, as bits of the box around them. They are drawn before the
// brush paints. Pure; any thread.

#include <cstdint>
#include <span>
#include <vector>

#include "engine/annotation/work/change.h"

namespace shvr {

struct PaintPreview {
    VoxelBox box;  ///< the smallest box around the voxels; empty if there are none
    std::vector<uint32_t>
        words;           ///< rows of words_per_row() words, z slowest; bit b of word w is x = lower.x + 32 w + b
    int64_t voxels = 0;  ///< number of voxels; at most 256^3, as in a brush's region
    enum class Kind { group, density, erase };
    Kind kind = Kind::group;  ///< `erase`: the voxels lose their group, or their offset

    bool contains(const Size3& voxel) const;
    int64_t words_per_row() const { return (box.size().x + 31) / 32; }
};

/// The voxels whose group or offset `changes` would change, in a volume of `volume_size`.
PaintPreview preview_of(std::span<const Change> changes, const Size3& volume_size, PaintPreview::Kind kind);

}  // namespace shvr
