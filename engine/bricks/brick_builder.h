#pragma once
// Cuts a source into bricks for the device: 16-bit codes with an apron of one voxel (edge voxels repeat at the volume's
// border), and the value range of every 4^3 cell and the neighbours that trilinear filtering reads.

#include <array>

#include "engine/bricks/code_rows.h"
#include "engine/volume/brick_key.h"
#include "engine/volume/source.h"
#include "shaders/bricks.h"

namespace shvr {

/// A brick as the device holds it. `codes` has gpu::BRICK_TEXELS a side, x fastest; voxels outside the volume repeat
/// the nearest voxel inside. `cell_ranges` holds, for each of the gpu::BRICK_CELLS^3 cells, minimum and maximum code
/// over every voxel that a trilinear sample inside the cell can touch (the cell's voxels and one voxel around).
struct BrickTexels {
    static constexpr size_t TEXELS = size_t{gpu::BRICK_TEXELS} * gpu::BRICK_TEXELS * gpu::BRICK_TEXELS;
    static constexpr size_t CELLS = size_t{gpu::BRICK_CELLS} * gpu::BRICK_CELLS * gpu::BRICK_CELLS;
    std::array<uint16_t, TEXELS> codes;
    struct Range {
        uint16_t minimum, maximum;
        bool operator==(const Range&) const = default;
    };
    std::array<Range, CELLS> cell_ranges;
    static constexpr size_t CODE_BYTES = TEXELS * sizeof(uint16_t), RANGE_BYTES = CELLS * sizeof(Range);
    Range range;  ///< over the whole brick, apron included
};

/// Number of bricks along each axis: ceil(size / BRICK_SIZE).
glm::ivec3 brick_counts(const Size3& size);

/// The voxels of a brick's level that its texels show: the brick and its apron, inside the volume.
VoxelBox voxels_of_texels(const BrickKey& key, const Size3& volume);

/// Builds single bricks of any level. Each thread must use its own object.
class BrickMaker {
public:
    BrickMaker(const VolumeSource& source, const IntensityWindow& window)
        : source_(source), code_rows_(source.info().type, window)
    {}

    void make(const BrickKey& key, BrickTexels& texels);

private:
    const VolumeSource& source_;
    CodeRows code_rows_;
    std::vector<std::byte> voxels_;
};

/// Builds every brick of level 0, in order of index (x fastest). Reads the source slab by slab, and each slice once.
/// Holds two slabs of 34 slices at a time, in the source's format, and a few rows of bricks. Calls `take` once per
/// brick, in order, on the calling thread, while `threads` workers read and build the next bricks. If the source or
/// `take` throws, stops the workers and rethrows.
void build_bricks(const VolumeSource& source, const IntensityWindow& window, int threads,
                  const std::function<void(const glm::ivec3& brick, const BrickTexels& texels)>& take);

}  // namespace shvr
