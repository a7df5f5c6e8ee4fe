// Brushes: declarations that the region and labelling kernels share with C++.
//
// A region's voxels are bits: 32 along x in one word, rows of `words_per_row` words, y next, z last. A run is a maximal
// sequence of set bits within one word, identified by the index of its first bit. The union-find forest of runs is
// stored in one uint per bit.
//   region_bits    bit = density code >= threshold, within the row's span
//   region_merge   connects each run with the runs before it (union-find with atomic minimum; Komura 2015, Playne and
//                  Hawick 2018): the root of a component is its lowest run, so the result does not depend on timing
//   region_mark    speckle fill: marks the roots whose component holds an edge voxel of the region
//   region_select  keeps the runs connected to the seed (flood fill), those with an unmarked root (speckle fill), or
//                  those with a marked one (touch)
//   region_roots   replaces region_bits if the bits are known (touch, also on coarser levels)
//   region_seeds   replaces region_mark: marks the roots whose component holds a seed
#ifndef SHVR_REGIONS_H
#define SHVR_REGIONS_H
#include "../bricks.h"

SHARED_BEGIN

/// Half-open range of x coordinates, relative to the region's first voxel.
struct RowSpan {
    int begin;
    int end;
};

struct RegionParams {
    uvec3 origin;  ///< voxel of the region's box
    uvec3 size;    ///< voxels
    uint words_per_row;
    uint threshold_code;  ///< 0 ... 65536
    uint connectivity;    ///< 6 or 26
    uint seed;            ///< index of the seed's bit; flood fill
    uvec3 brick_begin;    ///< the bricks that the region overlaps
    uvec3 brick_counts;
};

/// region.glsl needs `size` and `words_per_row`, as in RegionParams.
struct SeedParams {
    uvec3 size;  ///< voxels of the region
    uint words_per_row;
    ivec3 to_seeds;   ///< offset from a voxel of the region to the same voxel in the seeds' box
    uvec3 seed_size;  ///< voxels
    uint seed_words_per_row;
};

/// What region_select keeps.
SHARED_CONST uint KEEP_UNMARKED = 0u;
SHARED_CONST uint KEEP_SEED = 1u;
SHARED_CONST uint KEEP_MARKED = 2u;

SHARED_CONST uint NO_SEED = 0xffffffffu;

SHARED_END
#endif
