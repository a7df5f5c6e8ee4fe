#pragma once
// A slab of slices of a volume with one bit per voxel, set if the voxel is at or above the threshold. Holds only the
// parts that the source stores; all other voxels are below the threshold. For components.cpp.

#include <optional>
#include <vector>

#include "engine/components/threshold_bits.h"
#include "engine/volume/source.h"

namespace shvr {

/// The rows and columns of each slice that have bits: those that can hold voxels at or above the threshold.
class BitLayout {
public:
    struct Columns {
        int64_t lower = 0, upper = 0;
    };
    /// Rows [lower, upper) of a layer, with bits in these column ranges, which neither overlap nor touch.
    struct Strip {
        int64_t lower = 0, upper = 0;
        std::vector<Columns> columns{};
    };
    struct Layer {
        int64_t lower = 0, upper = 0;  ///< slices
        std::vector<Strip> strips{};
        int64_t words = 0;  ///< words of bits per slice
    };

    /// Covers the blocks in `stored`; if `stored` is null, covers all voxels by a single layer.
    BitLayout(const Size3& size, const std::optional<StoredBlocks>& stored);

    /// Returns the layer that contains slice z or, if none does, the next layer; null if there is none.
    const Layer* layer_from(int64_t z) const;
    int64_t words() const { return words_; }  ///< total of all slices

private:
    std::vector<Layer> layers_;
    int64_t words_ = 0;
};

class BitSlab {
public:
    /// All arguments must outlive it.
    BitSlab(const VolumeSource& source, const ThresholdBits& bits, const BitLayout& layout);

    /// Finds and reads the next slab at or after slice z and before `end`. Skips empty slices. The slab is as thick as
    /// the source's blocks, so that they are decoded only once, but takes at most 64 MiB of bits. Returns false if no
    /// slab is left. Does not read parts that the source knows to be below the threshold.
    bool read(int64_t z, int64_t end);
    int64_t lower() const { return lower_; }
    int64_t upper() const { return upper_; }
    /// Number of words in the slab, for progress relative to BitLayout::words.
    int64_t words() const { return layer_->words * (upper_ - lower_); }

    /// Calls `take(y, ends)`, in order, for each row of slice z that has runs. For each run, `ends` holds its first
    /// voxel and the voxel after its last.
    template <class Take>
    void for_each_row(int64_t z, const Take& take)
    {
        const uint64_t* words = words_.data() + (z - lower_) * layer_->words;
        for (const BitLayout::Strip& strip : layer_->strips)
            for (int64_t y = strip.lower; y < strip.upper; ++y) {
                ends_.clear();
                for (const BitLayout::Columns& columns : strip.columns) {
                    const auto count = size_t(words_of_row(columns.upper - columns.lower));
                    const size_t known = ends_.size();
                    append_run_ends({words, count}, columns.upper - columns.lower, ends_);
                    for (size_t i = known; i < ends_.size(); ++i) ends_[i] += uint32_t(columns.lower);
                    words += count;
                }
                if (!ends_.empty()) take(y, std::span<const uint32_t>(ends_));
            }
    }
    int64_t bytes() const
    {
        return int64_t(words_.capacity() * sizeof(uint64_t) + voxels_.capacity() + ends_.capacity() * sizeof(uint32_t));
    }

private:
    int64_t thickness_of(const BitLayout::Layer& layer) const;
    void read_strip(const BitLayout::Strip& strip, int64_t first_word);
    void read_part(const VoxelBox& part, int64_t first_word, int64_t words_of_rows);
    std::optional<BitLayout::Columns> columns_above(const VoxelBox& part) const;

    const VolumeSource& source_;
    const ThresholdBits& bits_;
    const BitLayout& layout_;
    Size3 block_;
    const BitLayout::Layer* layer_ = nullptr;
    int64_t lower_ = 0, upper_ = 0;
    std::vector<uint64_t> words_;
    std::vector<std::byte> voxels_;
    std::vector<uint32_t> ends_;
};

}  // namespace shvr
