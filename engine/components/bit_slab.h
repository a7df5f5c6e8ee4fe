#pragma once
// A slab of slices of a volume as bits: which voxels are at or above a threshold. For components.cpp.

#include <vector>

#include "engine/components/threshold_bits.h"
#include "engine/volume/source.h"

namespace shvr {

class BitSlab {
public:
    BitSlab(const VolumeSource& source, const ThresholdBits& bits);

    /// How many slices are read at once: enough for the source's blocks to be decoded once, unless the bits of that
    /// many slices take more than 64 MiB.
    int64_t slices() const { return slices_; }
    /// Slices [lower, upper), at most `slices()`. Blocks that the source knows to be below the threshold are not read.
    void read(int64_t lower, int64_t upper);
    /// Row y of slice `lower` + slice.
    std::span<const uint64_t> row(int64_t y, int64_t slice) const
    {
        return std::span(words_).subspan(size_t((y + slice * size_.y) * row_words_), size_t(row_words_));
    }
    int64_t bytes() const { return int64_t(words_.capacity() * sizeof(uint64_t) + voxels_.capacity()); }

private:
    void read_rows(int64_t lower, int64_t upper, int64_t lower_row, int64_t upper_row);
    std::pair<int64_t, int64_t> columns_above(const VoxelBox& strip) const;

    const VolumeSource& source_;
    const ThresholdBits& bits_;
    Size3 size_;
    int64_t row_words_, slices_, rows_;
    std::vector<uint64_t> words_;
    std::vector<std::byte> voxels_;
};

}  // namespace shvr
