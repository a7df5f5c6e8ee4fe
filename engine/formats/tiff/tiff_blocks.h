#pragma once
// Reads a rectangle of one page. Uncompressed samples are read straight into their destination. Blocks inside the
// rectangle are decoded into it; blocks that overlap it are decoded once and cached for neighbouring reads.

#include <map>
#include <mutex>
#include <tuple>

#include "engine/formats/tiff/tiff_samples.h"

namespace shvr {

/// The place of a slice in the volume's files.
struct TiffSlice {
    uint32_t file = 0;       ///< index into the volume's files
    uint32_t page = 1;       ///< number of the page in that file, for messages; 0: the file lacks it
    uint64_t directory = 0;  ///< in that file
    /// For ImageJ's stacks with one directory: offset of the slice's voxels from those that the directory describes.
    int64_t shift_bytes = 0;
};

/// Caches decoded blocks: at most `MAX_BYTES`, but always the latest block. Any thread may call it. If two threads need
/// the same block, it is decoded only once.
class TiffBlockCache {
public:
    static constexpr size_t MAX_BYTES = size_t{64} << 20;

    using Key = std::tuple<uint32_t, uint64_t, int64_t>;  ///< file, directory, block
    using Block = std::vector<std::byte>;

    template <class Decode>
    std::shared_ptr<const Block> get(const Key& key, const Decode& decode)
    {
        const std::shared_ptr<Entry> entry = entry_of(key);
        const std::lock_guard lock(entry->mutex);
        if (entry->block.empty()) {
            entry->block = decode();
            keep(key, entry);
        }
        return {entry, &entry->block};
    }

private:
    struct Entry {
        std::mutex mutex;
        Block block;
    };

    std::shared_ptr<Entry> entry_of(const Key& key);
    void keep(const Key& key, const std::shared_ptr<Entry>& entry);

    std::mutex mutex_;
    std::map<Key, std::shared_ptr<Entry>> entries_;
    std::vector<std::pair<Key, size_t>> kept_;  ///< with their sizes in bytes
    size_t kept_bytes_ = 0;
    uint32_t random_ = 1;
};

/// A half-open rectangle, in pixels of the page as stored.
struct TiffRectangle {
    int64_t left = 0, top = 0, right = 0, bottom = 0;
};

/// Reads a rectangle inside the page into `voxels`, row by row. Fails if the page is damaged or not as `expected`.
void read_rectangle(const TiffFile& file, const TiffSlice& slice, const TiffLayout& expected, const TiffRecipe& recipe,
                    const TiffRectangle& rectangle, TiffBlockCache& cache, std::span<std::byte> voxels);

}  // namespace shvr
