#include "engine/formats/slices/picture_file.h"

#include <unistd.h>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/voxel_bytes.h"
#include "engine/volume/grid.h"

namespace shvr {

bool PictureLayout::is_sliceable() const
{
    return samples - int(has_alpha) == 1;
}

std::string in_words(const PictureLayout& layout)
{
    return sentence(layout.width, "x", layout.height, " pixels of ",
                    layout.samples > 1 ? sentence(layout.samples, " samples of ") : std::string(),
                    name_of(layout.type));
}

std::optional<SliceFormat> picture_format(const std::filesystem::path& path)
{
    const std::string head = read_head(path, 32);
    if (head.starts_with("\x89PNG\r\n\x1a\n")) return SliceFormat::png;
    if (head.starts_with("\xff\xd8\xff")) return SliceFormat::jpeg;
    // "BM" alone is too weak a sign of a BMP: the four reserved bytes must also be 0, and the next header's size < 256.
    const bool is_bmp = head.starts_with("BM") && head.size() >= 18 && head.substr(6, 4) == std::string(4, '\0') &&
                        head.substr(15, 3) == std::string(3, '\0');
    return is_bmp ? std::optional(SliceFormat::bmp) : std::nullopt;
}

std::unique_ptr<PictureFile> open_picture(const std::filesystem::path& path, SliceFormat format)
{
    switch (format) {
        case SliceFormat::png: return open_png_picture(path);
        case SliceFormat::bmp: return open_bmp_picture(path);
        case SliceFormat::jpeg: return open_jpeg_picture(path);
        case SliceFormat::tiff: break;
    }
    SHVR_CHECK(false, "TIFFs have a reader of their own");
    return nullptr;
}

void check_picture_size(const std::filesystem::path& path, int64_t width, int64_t height)
{
    if (width >= 1 && height >= 1 && width <= MAX_SIDE && height <= MAX_SIDE) return;
    fail(path.string(), ": the picture is ", width, " x ", height, " pixels; expected 1 to ", MAX_SIDE, " a side");
}

void check_expansion(const std::filesystem::path& path, int64_t pixel_bytes, int64_t file_bytes, int64_t factor)
{
    if (pixel_bytes / factor <= file_bytes) return;
    fail(path.string(), ": holds ", file_bytes, " bytes; expected at least ", pixel_bytes / factor, " for its ",
         pixel_bytes, " bytes of pixels: it is truncated, or its size is wrong");
}

CFile open_c_file(const std::filesystem::path& path, int64_t& bytes)
{
    const InputFile file = open_input_file(path);
    bytes = file.bytes;
    const int copy = ::dup(file.descriptor.number());
    CFile opened(copy < 0 ? nullptr : ::fdopen(copy, "rb"));
    if (!opened) {
        if (copy >= 0) ::close(copy);
        fail(path.string(), ": cannot be opened: ", reason_of(errno));
    }
    return opened;
}

}  // namespace shvr
