// Reads BMP without compression, as scanners write it: 8 bits with a palette, 24 or 32 bits of colour.

#include <array>
#include <cstring>
#include <limits>

#include "engine/base/error.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/slices/picture_file.h"
#include "engine/formats/voxel_bytes.h"

namespace shvr {
namespace {

constexpr size_t FILE_HEADER = 14, MIN_HEADER = 40;

class BmpPicture final : public PictureFile {
public:
    explicit BmpPicture(const std::filesystem::path& path)
        : path_(path), file_(open_input_file(path)), head_(read_head(path, MAX_HEADER))
    {
        const int64_t header = int64_t{number<uint32_t>(14)};
        if (header < int64_t{MIN_HEADER} || header > 1024)
            refuse("header size", header, "40 or more: the headers of OS/2 are not supported");
        layout_.width = number<int32_t>(18);
        const int64_t rows = number<int32_t>(22);
        is_top_down_ = rows < 0;
        layout_.height = is_top_down_ ? -rows : rows;
        check_picture_size(path, layout_.width, layout_.height);
        bits_ = number<uint16_t>(28);
        if (bits_ != 8 && bits_ != 24 && bits_ != 32) refuse("bits per pixel", bits_, "8, 24 or 32");
        if (const int64_t compression = number<uint32_t>(30); compression != 0)
            refuse("compression", compression, "0: save it without compression");
        voxels_at_ = number<uint32_t>(10);
        stride_ = (layout_.width * bits_ + 31) / 32 * 4;
        const int64_t needed = voxels_at_ + stride_ * layout_.height;
        if (needed > file_.bytes)
            fail(path.string(), ": holds ", file_.bytes, " bytes; expected at least ", needed, " for ", layout_.width,
                 "x", layout_.height, " pixels of ", bits_, " bits");
        if (bits_ == 8) read_palette(FILE_HEADER + size_t(header));
        layout_.samples = bits_ == 8 && is_grey_ ? 1 : 3;
    }

    const PictureLayout& layout() const override { return layout_; }

    void read(int64_t first_row, int64_t end_row, const TakeRow& take) override
    {
        std::vector<std::byte> stored(static_cast<size_t>(stride_)), row(size_t(layout_.width * layout_.samples));
        for (int64_t y = first_row; y < end_row; ++y) {
            const int64_t in_file = is_top_down_ ? y : layout_.height - 1 - y;
            if (file_.read_some(voxels_at_ + in_file * stride_, stored) != stored.size())
                fail(path_.string(), ": was shortened while it was read; expected all of its pixels");
            for (int64_t x = 0; x < layout_.width; ++x) put(stored, x, row);
            take(y, row);
        }
    }

private:
    /// Enough for the headers and 256 colours.
    static constexpr size_t MAX_HEADER = 4096;

    template <class Number>
    Number number(size_t at) const
    {
        Number value = 0;
        if (at + sizeof(value) > head_.size()) fail(path_.string(), ": ends in its header; expected a BMP");
        std::memcpy(&value, head_.data() + at, sizeof(value));
        return value;
    }

    [[noreturn]] void refuse(const char* field, int64_t found, const char* expected) const
    {
        fail(path_.string(), ": ", field, " is ", found, "; expected ", expected);
    }

    void read_palette(size_t at)
    {
        const int64_t stated = number<uint32_t>(46), count = stated == 0 ? 256 : stated;
        if (count > 256) refuse("number of colours", count, "at most 256");
        for (size_t i = 0; i < size_t(count); ++i) {
            const uint32_t color = number<uint32_t>(at + 4 * i);
            palette_[i] = {uint8_t(color >> 16), uint8_t(color >> 8), uint8_t(color)};
            is_grey_ = is_grey_ && palette_[i][0] == palette_[i][1] && palette_[i][0] == palette_[i][2];
        }
    }

    /// Stored as blue, green, red.
    void put(const std::vector<std::byte>& stored, int64_t x, std::vector<std::byte>& row) const
    {
        const auto samples = size_t(layout_.samples);
        const size_t to = size_t(x) * samples, from = size_t(x) * size_t(bits_ / 8);
        for (size_t sample = 0; sample < samples; ++sample)
            row[to + sample] = bits_ == 8 ? std::byte{palette_[std::to_integer<size_t>(stored[from])][sample]}
                                          : stored[from + 2 - sample];
    }

    std::filesystem::path path_;
    InputFile file_;
    std::string head_;
    PictureLayout layout_;
    std::array<std::array<uint8_t, 3>, 256> palette_{};
    bool is_top_down_ = false, is_grey_ = true;
    int64_t bits_ = 0, voxels_at_ = 0, stride_ = 0;
};

}  // namespace

std::unique_ptr<PictureFile> open_bmp_picture(const std::filesystem::path& path)
{
    return std::make_unique<BmpPicture>(path);
}

}  // namespace shvr
