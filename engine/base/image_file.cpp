#include "engine/base/image_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {
namespace {

using Bytes = std::span<const std::byte>;

// The largest pictures hold 1 GiB of pixels, which do not compress if they are noise.
constexpr int64_t LARGEST_PNG_FILE = int64_t{2} << 30;

// The maximum expansion of a deflate stream.
constexpr int64_t LARGEST_DEFLATE_RATIO = 1032;

constexpr size_t SIGNATURE_BYTES = 8;
constexpr size_t CHUNK_FRAME_BYTES = 12;  // length, type and checksum around the data
constexpr size_t HEADER_END = SIGNATURE_BYTES + CHUNK_FRAME_BYTES + 13;

int64_t number_at(Bytes file, size_t offset)
{
    int64_t number = 0;
    for (const std::byte byte : file.subspan(offset, 4)) number = number * 256 + std::to_integer<int64_t>(byte);
    return number;
}

/// Bits per pixel from the depth and colour type in the header; nothing if the type does not exist.
std::optional<int64_t> bits_of_pixel(Bytes file)
{
    const auto depth = std::to_integer<int64_t>(file[24]);
    switch (std::to_integer<int>(file[25])) {
        case PNG_COLOR_TYPE_GRAY:
        case PNG_COLOR_TYPE_PALETTE: return depth;
        case PNG_COLOR_TYPE_GRAY_ALPHA: return 2 * depth;
        case PNG_COLOR_TYPE_RGB: return 3 * depth;
        case PNG_COLOR_TYPE_RGB_ALPHA: return 4 * depth;
        default: return {};
    }
}

void check_size(int64_t width, int64_t height, std::string_view name)
{
    // Compared by division: the product of hostile sizes could overflow.
    if (width < 1 || height < 1 || width > MAX_IMAGE_PIXELS / height) {
        fail(name, ": the picture is ", width, " x ", height, " pixels; expected 1 to ", MAX_IMAGE_PIXELS, " of them");
    }
}

/// libpng stops reading after the last row, so it would accept a file whose last bytes are missing.
void check_chunks(Bytes file, std::string_view name)
{
    for (size_t start = SIGNATURE_BYTES; start + CHUNK_FRAME_BYTES <= file.size();) {
        if (number_at(file, start + 4) == 0x49454e44) return;  // IEND
        start += size_t(number_at(file, start)) + CHUNK_FRAME_BYTES;
    }
    fail(name, ": ends after ", file.size(), " bytes; expected an IEND chunk");
}

/// All checks made before memory is allocated for the pixels.
void check_file(Bytes file, std::string_view name)
{
    static constexpr std::array<std::byte, SIGNATURE_BYTES> SIGNATURE{std::byte{0x89}, std::byte{'P'},  std::byte{'N'},
                                                                      std::byte{'G'},  std::byte{'\r'}, std::byte{'\n'},
                                                                      std::byte{0x1a}, std::byte{'\n'}};
    if (file.size() < SIGNATURE_BYTES || !std::equal(SIGNATURE.begin(), SIGNATURE.end(), file.begin())) {
        fail(name, ": is no PNG file");
    }
    if (file.size() < HEADER_END) fail(name, ": ends after ", file.size(), " bytes; expected a PNG header");
    const int64_t width = number_at(file, 16), height = number_at(file, 20);
    check_size(width, height, name);
    const auto bits = bits_of_pixel(file);
    if (!bits) fail(name, ": the colour type is ", std::to_integer<int>(file[25]), "; expected 0, 2, 3, 4 or 6");
    if (width * height * *bits / 8 / LARGEST_DEFLATE_RATIO > int64_t(file.size())) {
        fail(name, ": holds ", file.size(), " bytes, too few for the ", width, " x ", height,
             " pixels that its header tells of");
    }
    check_chunks(file, name);
}

/// libpng's simplified interface, which reports errors by return value, so no longjmp skips our destructors.
struct PngImage {
    png_image image{};

    PngImage() { image.version = PNG_IMAGE_VERSION; }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
    ~PngImage() { png_image_free(&image); }
};

}  // namespace

Image8 decode_png(Bytes file, std::string_view name)
{
    check_file(file, name);
    PngImage png;
    if (png_image_begin_read_from_memory(&png.image, file.data(), file.size()) == 0) {
        fail(name, ": is not a valid PNG file: ", png.image.message);
    }
    png.image.format = PNG_FORMAT_RGBA;
    // Without this flag, 16-bit files without a gAMA chunk count as linear, which hardly any of them is.
    png.image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    Image8 decoded{int(png.image.width), int(png.image.height), std::vector<uint8_t>(PNG_IMAGE_SIZE(png.image))};
    if (png_image_finish_read(&png.image, nullptr, decoded.rgba.data(), 0, nullptr) == 0) {
        fail(name, ": is not a valid PNG file: ", png.image.message);
    }
    return decoded;
}

std::vector<std::byte> encode_png(const Image8& image, std::string_view name)
{
    check_size(image.width, image.height, name);
    const size_t values = 4 * size_t(image.width) * size_t(image.height);
    SHVR_CHECK(image.rgba.size() == values, image.rgba.size(), " != ", values);
    PngImage png;
    png.image.width = static_cast<png_uint_32>(image.width);
    png.image.height = static_cast<png_uint_32>(image.height);
    png.image.format = PNG_FORMAT_RGBA;
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png.image);
    std::vector<std::byte> file(bytes);
    if (png_image_write_to_memory(&png.image, file.data(), &bytes, 0, image.rgba.data(), 0, nullptr) == 0) {
        fail(name, ": cannot be encoded as PNG: ", png.image.message);
    }
    file.resize(bytes);
    return file;
}

Image8 read_png(const std::filesystem::path& path)
{
    return decode_png(read_file(path, LARGEST_PNG_FILE), path.string());
}

void write_png(const std::filesystem::path& path, const Image8& image)
{
    write_file_atomically(path, encode_png(image, path.string()));
}

void write_pfm(const std::filesystem::path& path, const ImageF& image)
{
    check_size(image.width, image.height, path.string());
    const auto row_values = 4 * size_t(image.width);
    const auto rows = size_t(image.height);
    SHVR_CHECK(image.rgba.size() == row_values * rows, image.rgba.size(), " != ", row_values * rows);
    // The sign of the scale gives the byte order: negative is little-endian.
    const char* scale = std::endian::native == std::endian::little ? "-1.0" : "1.0";
    const std::string header = sentence("PF\n", image.width, " ", image.height, "\n", scale, "\n");
    constexpr size_t PIXEL_BYTES = 3 * sizeof(float);
    std::vector<std::byte> file(header.size() + PIXEL_BYTES * (row_values / 4) * rows);
    std::memcpy(file.data(), header.data(), header.size());
    std::byte* next = file.data() + header.size();
    for (size_t row = rows; row-- > 0;) {  // from the bottom up
        for (size_t at = row * row_values; at < (row + 1) * row_values; at += 4) {
            std::memcpy(next, &image.rgba[at], PIXEL_BYTES);
            next += PIXEL_BYTES;
        }
    }
    write_file_atomically(path, file);
}

}  // namespace shvr
