#pragma once
// A slab of slices of a volume with one bit per voxel, set if the voxel is at or above the threshold. Holds only the
// parts that the source stores; all other voxels are below the threshold. For components.cpp.

#include <algorithm>
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

    /// The bits of a row, and those of its neighbours in the same slice and in the slice before.
    struct Row {
        int64_t y = 0;
        std::span<const uint32_t> ends{};  ///< each run's first voxel and the voxel after its last
        const BitLayout::Strip* strip = nullptr;
        const uint64_t* words = nullptr;   ///< all columns, one after another; the strip's other rows lie around it
        const uint64_t* before = nullptr;  ///< the same of the slice before; null if its bits are not known
        std::ptrdiff_t pitch = 0;          ///< words from one row of the strip to the next

        /// The bits of row y + dy in slice z + dz; null if they lie elsewhere.
        const uint64_t* words_at(int64_t dy, int64_t dz) const
        {
            const uint64_t* const own = dz == 0 ? words : before;
            return own == nullptr || y + dy < strip->lower || y + dy >= strip->upper ? nullptr : own + dy * pitch;
        }
    };

    /// Calls `take(Row)`, in order, for each row of slice z that has runs.
    template <class Take>
    void for_each_row(int64_t z, const Take& take)
    {
        const uint64_t* words = words_of(z);
        const uint64_t* before = words_of(z - 1);
        for (const BitLayout::Strip& strip : layer_->strips) {
            const std::ptrdiff_t pitch = words_of_strip(strip);
            ends_.resize(std::max(ends_.size(), size_t(64 * pitch) + strip.columns.size()));
            for (int64_t y = strip.lower; y < strip.upper;
                 ++y, words += pitch, before += before == nullptr ? 0 : pitch) {
                const std::span<const uint32_t> ends = ends_of(strip, words);
                if (!ends.empty())
                    take(Row{.y = y, .ends = ends, .strip = &strip, .words = words, .before = before, .pitch = pitch});
            }
        }
    }
    int64_t bytes() const
    {
        return int64_t((words_.capacity() + before_.capacity()) * sizeof(uint64_t) + voxels_.capacity() +
                       ends_.capacity() * sizeof(uint32_t));
    }

private:
    static std::ptrdiff_t words_of_strip(const BitLayout::Strip& strip)
    {
        std::ptrdiff_t words = 0;
        for (const BitLayout::Columns& columns : strip.columns) words += words_of_row(columns.upper - columns.lower);
        return words;
    }
    const uint64_t* words_of(int64_t z) const
    {
        if (z >= lower_) return words_.data() + (z - lower_) * layer_->words;
        return before_.empty() ? nullptr : before_.data();
    }
    std::span<const uint32_t> ends_of(const BitLayout::Strip& strip, const uint64_t* words)
    {
        uint32_t* to = ends_.data();
        for (const BitLayout::Columns& columns : strip.columns) {
            to = write_run_ends(words, columns.lower, columns.upper, to);
            words += words_of_row(columns.upper - columns.lower);
        }
        return {ends_.data(), to};
    }
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
    std::vector<uint64_t> before_;  ///< the slice before the slab; empty if its layout is another
    std::vector<std::byte> voxels_;
    std::vector<uint32_t> ends_;
};

}  // namespace shvr
