// Reads PNG: 1 to 16 bits, grey, palette or colour.

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <exception>

#include "engine/base/error.h"
#include "engine/formats/slices/picture_file.h"

namespace shvr {
namespace {

/// The maximum expansion of a deflate stream.
constexpr int64_t MAX_DEFLATE_RATIO = 1032;

class PngPicture final : public PictureFile {
public:
    explicit PngPicture(const std::filesystem::path& path) : path_(path), file_(open_c_file(path, file_bytes_))
    {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &PngPicture::note_error, &PngPicture::ignore);
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (!info_) fail(path.string(), ": cannot be read: no memory is left");
        png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
        png_set_chunk_malloc_max(png_, png_alloc_size_t{8} << 20);
        read_header();
        check_stored();
        set_conversions();
        layout_.samples = png_get_channels(png_, info_);
        layout_.type = png_get_bit_depth(png_, info_) == 16 ? VoxelType::uint16 : VoxelType::uint8;
        layout_.has_alpha = (png_get_color_type(png_, info_) & PNG_COLOR_MASK_ALPHA) != 0;
    }
    const PictureLayout& layout() const override { return layout_; }

    void read(int64_t first_row, int64_t end_row, const TakeRow& take) override
    {
        const size_t row_bytes = png_get_rowbytes(png_, info_);
        pixels_.resize(row_bytes * size_t(is_interlaced_ ? layout_.height : 1));
        for (int64_t y = 0; y < end_row || (is_interlaced_ && y < layout_.height * passes_); ++y) {
            std::byte* const row = pixels_.data() + (is_interlaced_ ? size_t(y % layout_.height) * row_bytes : 0);
            read_row(row);
            if (!is_interlaced_ && y >= first_row) take(y, {row, row_bytes});
        }
        for (int64_t y = first_row; is_interlaced_ && y < end_row; ++y)
            take(y, std::span(pixels_).subspan(size_t(y) * row_bytes, row_bytes));
        // After the last row, checks that the rest of the file is there as well.
        if (end_row == layout_.height) finish();
    }

private:
    static void note_error(png_structp png, png_const_charp message)
    {
        static_cast<PngPicture*>(png_get_error_ptr(png))->error_ = message;
        png_longjmp(png, 1);
    }
    static void ignore(png_structp, png_const_charp) {}

    [[noreturn]] void refuse() const
    {
        fail(path_.string(), ": is no sound PNG (libpng: ", error_, "); expected one that is complete");
    }

    // On errors, libpng uses longjmp to return to the functions below, so these create no objects with destructors.

    void read_header()
    {
        if (setjmp(png_jmpbuf(png_)) != 0) refuse();
        png_init_io(png_, file_.get());
        png_read_info(png_, info_);
    }

    /// Checks the header before memory is allocated for pixels.
    void check_stored()
    {
        layout_.width = png_get_image_width(png_, info_);
        layout_.height = png_get_image_height(png_, info_);
        check_picture_size(path_, layout_.width, layout_.height);
        const int64_t bits = int64_t{png_get_bit_depth(png_, info_)} * png_get_channels(png_, info_);
        const int64_t pixel_bytes = (layout_.width * bits + 7) / 8 * layout_.height;
        check_expansion(path_, pixel_bytes, file_bytes_, MAX_DEFLATE_RATIO);
        is_interlaced_ = png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE;
        const int64_t whole = layout_.width * layout_.height * std::max<int64_t>(bits / 8, 4);
        if (is_interlaced_ && whole > MAX_WHOLE_PICTURE_BYTES)
            fail(path_.string(), ": is interlaced and has ", layout_.width, "x", layout_.height,
                 " pixels, which are decoded at once; expected at most ", MAX_WHOLE_PICTURE_BYTES,
                 " bytes of them: save it without interlacing");
    }

    /// Asks libpng for values as stored, except that palettes are expanded to grey or colours.
    void set_conversions()
    {
        if (setjmp(png_jmpbuf(png_)) != 0) refuse();
        png_set_packing(png_);
        png_set_swap(png_);
        if (png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE) {
            png_set_palette_to_rgb(png_);
            if (has_grey_palette()) png_set_rgb_to_gray_fixed(png_, PNG_ERROR_ACTION_NONE, -1, -1);
        }
        passes_ = png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
    }

    bool has_grey_palette() const
    {
        png_color* palette = nullptr;
        int count = 0;
        if (png_get_PLTE(png_, info_, &palette, &count) == 0) return false;
        return std::all_of(palette, palette + count,
                           [](const png_color& color) { return color.red == color.green && color.red == color.blue; });
    }

    void read_row(std::byte* row)
    {
        if (setjmp(png_jmpbuf(png_)) != 0) refuse();
        png_read_row(png_, reinterpret_cast<png_bytep>(row), nullptr);
    }

    void finish()
    {
        if (setjmp(png_jmpbuf(png_)) != 0) refuse();
        png_read_end(png_, nullptr);
    }

    std::filesystem::path path_;
    int64_t file_bytes_ = 0;
    CFile file_;
    struct Handles {
        png_struct* png = nullptr;
        png_info* info = nullptr;
        Handles() = default;
        Handles(const Handles&) = delete;
        ~Handles() { png_destroy_read_struct(&png, &info, nullptr); }
    };
    Handles handles_;
    png_struct*& png_ = handles_.png;
    png_info*& info_ = handles_.info;
    std::string error_;
    PictureLayout layout_;
    bool is_interlaced_ = false;
    int passes_ = 1;
    std::vector<std::byte> pixels_;
};

}  // namespace

std::unique_ptr<PictureFile> open_png_picture(const std::filesystem::path& path)
{
    return std::make_unique<PngPicture>(path);
}

}  // namespace shvr
