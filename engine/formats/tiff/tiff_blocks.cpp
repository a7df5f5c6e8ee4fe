#include "engine/formats/tiff/tiff_blocks.h"

#include <tiffio.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/formats/byte_order.h"

namespace shvr {
namespace {

/// Uncompressed rows that cannot be read straight into their destination are read in parts of this size.
constexpr int64_t PART_BYTES = int64_t{1} << 20;

/// The part of a block that lies inside the rectangle, in rows and columns of the block; `voxels` is its destination.
struct Part {
    int64_t block = 0;
    int64_t top = 0, bottom = 0, left = 0, right = 0;
    std::byte* voxels = nullptr;
};

class RectangleReader {
public:
    RectangleReader(const TiffFile& file, const TiffSlice& slice, const TiffLayout& expected, const TiffRecipe& recipe,
                    TiffBlockCache& cache)
        : file_(file),
          slice_(slice),
          recipe_(recipe),
          cache_(cache),
          page_(file, slice.directory, slice.page, decoding_memory(file, expected)),
          layout_(layout_of(page_)),
          is_plain_(is_plain(layout_, recipe))
    {
        if (!show_the_same(layout_, expected)) {
            fail(page_.subject(), ": has ", in_words(layout_), "; expected ", in_words(expected),
                 ", as the others of the volume");
        }
        check_is_supported(page_, layout_);
        if (layout_.compression == COMPRESSION_JPEG) {
            TIFFSetField(page_.handle(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
        }
        const auto rows = uint32_t(layout_.rows_of_block(0));
        const int64_t row_bytes =
            layout_.is_tiled ? TIFFTileRowSize(page_.handle()) : TIFFVStripSize(page_.handle(), rows) / rows;
        if (row_bytes != layout_.block_row_bytes()) {
            fail(page_.subject(), ": has rows of ", row_bytes, " bytes; expected ", layout_.block_row_bytes(), " for ",
                 in_words(layout_));
        }
        if (recipe.palette_color >= 0) palette_ = palette_of(page_, layout_, recipe.palette_color);
    }

    void read(const TiffRectangle& rectangle, std::span<std::byte> voxels)
    {
        const int64_t width = rectangle.right - rectangle.left;
        const auto voxel_bytes = int64_t(bytes_of(recipe_.type));
        row_pitch_ = width * voxel_bytes;
        const int64_t plane = layout_.is_planar ? recipe_.sample * layout_.blocks_across() * layout_.blocks_down() : 0;
        for (int64_t y = rectangle.top / layout_.block_height; y * layout_.block_height < rectangle.bottom; ++y) {
            for (int64_t x = rectangle.left / layout_.block_width; x * layout_.block_width < rectangle.right; ++x) {
                const int64_t first_row = y * layout_.block_height;
                const int64_t first_column = x * layout_.block_width;
                Part part;
                part.block = plane + y * layout_.blocks_across() + x;
                part.top = std::max<int64_t>(0, rectangle.top - first_row);
                part.bottom = std::min(layout_.block_height, rectangle.bottom - first_row);
                part.left = std::max<int64_t>(0, rectangle.left - first_column);
                part.right = std::min(layout_.block_width, rectangle.right - first_column);
                const int64_t below = first_row + part.top - rectangle.top;
                const int64_t beside = first_column + part.left - rectangle.left;
                part.voxels = voxels.data() + below * row_pitch_ + beside * voxel_bytes;
                const bool is_whole_rows = part.left == 0 && part.right == layout_.block_width && width == part.right;
                const bool is_whole = is_whole_rows && part.top == 0 && part.bottom == layout_.rows_of_block(y);
                read_part(part, is_plain_ && is_whole_rows, is_plain_ && is_whole && !layout_.is_tiled);
            }
        }
        finish_run();
        if (layout_.is_bare() && is_plain_) put_in_order(voxels);
        exchange_bits(recipe_, voxels);
    }

private:
    void read_part(const Part& part, bool rows_are_voxels, bool block_is_voxels)
    {
        const TiffExtent extent = extent_of_block(file_, page_, layout_, part.block);
        const auto bytes = size_t((part.bottom - part.top) * layout_.block_row_bytes());
        if (layout_.is_bare()) {
            const int64_t offset = extent.offset + slice_.shift_bytes + part.top * layout_.block_row_bytes();
            if (rows_are_voxels) return add_to_run(offset, {part.voxels, bytes});
            return read_bare(part, offset);
        }
        if (block_is_voxels) return decode(part.block, {part.voxels, bytes});
        const std::shared_ptr<const TiffBlockCache::Block> block =
            cache_.get({slice_.file, slice_.directory, part.block}, [&] {
                const int64_t row_of_blocks = part.block / layout_.blocks_across() % layout_.blocks_down();
                TiffBlockCache::Block decoded(size_t(layout_.rows_of_block(row_of_blocks) * layout_.block_row_bytes()));
                decode(part.block, decoded);
                return decoded;
            });
        const auto offset = size_t(part.top * layout_.block_row_bytes());
        unpack(part, std::span(*block).subspan(offset, bytes), part.voxels);
    }

    void decode(int64_t block, std::span<std::byte> bytes)
    {
        const auto index = uint32_t(block);
        const auto size = static_cast<tmsize_t>(bytes.size());
        const tmsize_t count = layout_.is_tiled ? TIFFReadEncodedTile(page_.handle(), index, bytes.data(), size)
                                                : TIFFReadEncodedStrip(page_.handle(), index, bytes.data(), size);
        if (count == size) return;
        fail(page_.subject(), ": ", layout_.is_tiled ? "tile " : "strip ", block + 1, " of ", layout_.blocks(),
             " cannot be decoded: ", page_.complaint(), "; expected ", size, " bytes of voxels");
    }

    /// Extends the current read by `bytes` if they follow it in both file and memory; otherwise begins a new read.
    void add_to_run(int64_t offset, std::span<std::byte> bytes)
    {
        const bool follows =
            !run_.empty() && run_offset_ + int64_t(run_.size()) == offset && run_.data() + run_.size() == bytes.data();
        if (follows) {
            run_ = {run_.data(), run_.size() + bytes.size()};
            return;
        }
        finish_run();
        run_ = bytes;
        run_offset_ = offset;
    }
    void finish_run()
    {
        if (!run_.empty()) file_.read(run_offset_, run_);
        run_ = {};
    }

    void read_bare(Part part, int64_t offset)
    {
        const int64_t row_bytes = layout_.block_row_bytes();
        const int64_t max_rows = std::clamp<int64_t>(PART_BYTES / row_bytes, 1, part.bottom - part.top);
        std::vector<std::byte> rows(size_t(max_rows * row_bytes));
        const int64_t bottom = part.bottom;
        for (; part.top < bottom; part.top = part.bottom) {
            part.bottom = std::min(bottom, part.top + max_rows);
            const std::span<std::byte> read = std::span(rows).first(size_t((part.bottom - part.top) * row_bytes));
            file_.read(offset, read);
            if (!is_plain_) put_in_order(read);
            unpack(part, read, part.voxels);
            offset += int64_t(read.size());
            part.voxels += (part.bottom - part.top) * row_pitch_;
        }
    }

    void unpack(const Part& part, std::span<const std::byte> rows, std::byte* voxels) const
    {
        const auto bytes = size_t(part.right - part.left) * bytes_of(recipe_.type);
        const auto row_bytes = size_t(layout_.block_row_bytes());
        for (int64_t row = part.top; row < part.bottom; ++row, voxels += row_pitch_) {
            unpack_row(layout_, recipe_, palette_, rows.first(row_bytes), part.left, {voxels, bytes});
            rows = rows.subspan(row_bytes);
        }
    }

    /// Converts to the machine's byte order; libtiff has already done so for compressed blocks.
    void put_in_order(std::span<std::byte> samples) const
    {
        if (file_.is_big_endian() && layout_.bits % 8 == 0) swap_bytes(samples, size_t(layout_.bits / 8));
    }

    const TiffFile& file_;
    const TiffSlice& slice_;
    const TiffRecipe& recipe_;
    TiffBlockCache& cache_;
    TiffPage page_;
    TiffLayout layout_;
    bool is_plain_;
    std::vector<uint16_t> palette_;
    int64_t row_pitch_ = 0;
    std::span<std::byte> run_{};
    int64_t run_offset_ = 0;
};

}  // namespace

std::shared_ptr<TiffBlockCache::Entry> TiffBlockCache::entry_of(const Key& key)
{
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Entry>& entry = entries_[key];
    if (!entry) entry = std::make_shared<Entry>();
    return entry;
}

void TiffBlockCache::keep(const Key& key, const std::shared_ptr<Entry>& entry)
{
    const std::lock_guard lock(mutex_);
    // Evicts at random: a repeated pass through a large volume would need exactly the blocks that LRU has evicted.
    while (!kept_.empty() && kept_bytes_ + entry->block.size() > MAX_BYTES) {
        random_ = random_ * 1664525u + 1013904223u;
        std::swap(kept_[random_ % kept_.size()], kept_.back());
        entries_.erase(kept_.back().first);
        kept_bytes_ -= kept_.back().second;
        kept_.pop_back();
    }
    kept_.emplace_back(key, entry->block.size());
    kept_bytes_ += entry->block.size();
}

void read_rectangle(const TiffFile& file, const TiffSlice& slice, const TiffLayout& expected, const TiffRecipe& recipe,
                    const TiffRectangle& rectangle, TiffBlockCache& cache, std::span<std::byte> voxels)
{
    RectangleReader(file, slice, expected, recipe, cache).read(rectangle, voxels);
}

}  // namespace shvr
