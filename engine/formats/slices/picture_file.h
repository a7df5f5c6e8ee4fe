#pragma once
// Reads PNG, BMP and JPEG files as slices: size, samples and rows. libpng and libjpeg decode; BMP needs no library.
// Sizes are checked against the file before memory is allocated, and rows are decoded one at a time. Any thread may
// call these.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/formats/slices/slice_names.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Maximum memory for a whole picture, needed for PNGs and JPEGs in several passes, which cannot be decoded row by row.
inline constexpr int64_t MAX_WHOLE_PICTURE_BYTES = int64_t{256} << 20;

struct PictureLayout {
    int64_t width = 0, height = 0;
    VoxelType type = VoxelType::uint8;
    int samples = 1;            ///< per pixel, as rows hold them
    bool has_alpha = false;     ///< the last sample
    bool is_sliceable() const;  ///< whether each pixel has one value, apart from alpha
    bool operator==(const PictureLayout&) const = default;
};
/// Returns, for example, "512x512 pixels of uint8" or "512x512 pixels of 3 samples of uint8".
std::string in_words(const PictureLayout& layout);

/// Receives row `y` of a picture: `samples` values per pixel, in native byte order.
using TakeRow = std::function<void(int64_t y, std::span<const std::byte> row)>;

class PictureFile {
public:
    virtual ~PictureFile() = default;
    virtual const PictureLayout& layout() const = 0;
    /// Calls `take` for rows `first_row` up to, but not including, `end_row`, in order. May be called only once.
    virtual void read(int64_t first_row, int64_t end_row, const TakeRow& take) = 0;
};

/// Returns the format, recognised by the file's first bytes; null for all other formats, including TIFF.
std::optional<SliceFormat> picture_format(const std::filesystem::path& path);
/// Reads the header. Fails, naming the file, if the header is damaged, of another format, or not supported.
std::unique_ptr<PictureFile> open_picture(const std::filesystem::path& path, SliceFormat format);

// One for each format, for open_picture.
std::unique_ptr<PictureFile> open_png_picture(const std::filesystem::path& path);
std::unique_ptr<PictureFile> open_bmp_picture(const std::filesystem::path& path);
std::unique_ptr<PictureFile> open_jpeg_picture(const std::filesystem::path& path);

/// Fails unless each side is 1 to 2^20.
void check_picture_size(const std::filesystem::path& path, int64_t width, int64_t height);
/// Fails if `pixel_bytes` exceeds `file_bytes` times `factor`, the maximum expansion of the file's compression. Such a
/// file is truncated, or made to exhaust memory.
void check_expansion(const std::filesystem::path& path, int64_t pixel_bytes, int64_t file_bytes, int64_t factor);

/// Closes files that are read by C libraries; the deleter of CFile.
struct CloseFile {
    void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
};
using CFile = std::unique_ptr<std::FILE, CloseFile>;
/// Opens a file and sets `bytes` to its size. Fails for folders, pipes and devices.
CFile open_c_file(const std::filesystem::path& path, int64_t& bytes);

}  // namespace shvr
