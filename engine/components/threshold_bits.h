#pragma once
// Converts rows of voxels to bits, set at or above a threshold, and bits to runs. Any thread.

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// Returns the number of 64-bit words for the bits of a row of `voxels` voxels.
inline int64_t words_of_row(int64_t voxels)
{
    return (voxels + 63) / 64;
}

class ThresholdBits {
public:
    /// `threshold` is an intensity; it may be +-infinity but not NaN (SHVR_CHECK).
    ThresholdBits(VoxelType type, double threshold);

    VoxelType type() const { return type_; }
    /// Whether voxels with values in `range` can be at or above the threshold.
    bool reaches(const ValueRange& range) const { return range.lower <= range.upper && range.upper >= threshold_; }

    /// Sets bit b of word w if voxel 64 w + b is at or above the threshold; NaN counts as below. Bits beyond the row
    /// are 0. `voxels` are in native byte order and aligned for their type.
    void convert(std::span<const std::byte> voxels, std::span<uint64_t> words) const;

private:
    VoxelType type_;
    double threshold_;
};

/// Writes the first voxel of each run of set bits, and the voxel after its last, and returns where they end: after at
/// most 64 a word, and one. The bits are voxels [lower, upper); bits beyond `upper` must be 0.
inline uint32_t* write_run_ends(const uint64_t* words, int64_t lower, int64_t upper, uint32_t* to)
{
    uint64_t before = 0;
    for (int64_t voxel = lower; voxel < upper; voxel += 64) {
        const uint64_t bits = *words++;
        // An edge bit is set where a bit differs from the one before, which is at the start of a run or after its end.
        uint64_t edges = bits ^ (bits << 1 | before);
        before = bits >> 63;
        for (; edges != 0; edges &= edges - 1) *to++ = uint32_t(voxel) + uint32_t(std::countr_zero(edges));
    }
    if (before != 0) *to++ = uint32_t(upper);
    return to;
}

}  // namespace shvr
