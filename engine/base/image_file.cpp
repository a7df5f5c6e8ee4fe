#include "engine/base/image_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <exception>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/image_tiff.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

using Bytes = std::span<const std::byte>;

// Maximum file size: pixels take at most 1 GiB, and a PNG of noise is no smaller than its pixels.
constexpr int64_t MAX_PNG_BYTES = int64_t{2} << 30;

// The maximum expansion of a deflate stream.
constexpr int64_t MAX_DEFLATE_RATIO = 1032;

constexpr size_t SIGNATURE_BYTES = 8;
constexpr size_t CHUNK_FRAME_BYTES = 12;  // length, type and checksum around the data
constexpr size_t HEADER_END = SIGNATURE_BYTES + CHUNK_FRAME_BYTES + 13;

int64_t number_at(Bytes file, size_t offset)
{
    int64_t number = 0;
    for (const std::byte byte : file.subspan(offset, 4)) number = number * 256 + std::to_integer<int64_t>(byte);
    return number;
}

/// Bits per pixel from the depth and colour type in the header; null if the type does not exist.
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
    // Divides by the height instead of multiplying, since the product of the sizes in a malicious file could overflow.
    if (width < 1 || height < 1 || width > MAX_IMAGE_PIXELS / height) {
        fail(name, ": the picture is ", width, " x ", height, " pixels; expected 1 to ", MAX_IMAGE_PIXELS, " of them");
    }
}

/// Checks all chunks, since libpng stops reading after the last row and would accept a file without its last bytes.
void check_chunks(Bytes file, std::string_view name)
{
    for (size_t start = SIGNATURE_BYTES; start + CHUNK_FRAME_BYTES <= file.size();) {
        if (number_at(file, start + 4) == 0x49454e44) return;  // IEND
        start += size_t(number_at(file, start)) + CHUNK_FRAME_BYTES;
    }
    fail(name, ": ends after ", file.size(), " bytes; expected an IEND chunk");
}

/// Performs all checks before memory is allocated for the pixels.
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
    if (width * height * *bits / 8 / MAX_DEFLATE_RATIO > int64_t(file.size())) {
        fail(name, ": holds ", file.size(), " bytes, too few for the ", width, " x ", height,
             " pixels that its header tells of");
    }
    check_chunks(file, name);
}

/// Uses libpng's simplified interface: it reports errors by return value, so no longjmp skips our destructors.
struct PngImage {
    png_image image{};

    PngImage() { image.version = PNG_IMAGE_VERSION; }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
    ~PngImage() { png_image_free(&image); }
};

/// Calls libpng, which reports errors by longjmp. The skipped stack frames must not contain objects with destructors.
template <class Call>
bool succeeds(png_structp png, const Call& call)
{
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    call();
    return true;
}

/// Encodes a picture row by row, and passes each piece of the file to `take` as libpng produces it.
class PngStream {
public:
    using Take = std::function<void(Bytes)>;
    PngStream(int64_t width, int64_t height, std::string_view name, Take take, const PictureTexts& texts = {})
        : name_(name), take_(std::move(take))
    {
        std::vector<png_text> chunks;
        for (const auto& [keyword, text] : texts) {
            if (text.size() > MAX_PICTURE_TEXT)
                fail(name_, ": its text '", keyword, "' has ", text.size(), " bytes; expected at most ",
                     MAX_PICTURE_TEXT);
            png_text& chunk = chunks.emplace_back();
            chunk.compression = PNG_ITXT_COMPRESSION_zTXt;
            chunk.key = const_cast<char*>(keyword.c_str());  // libpng copies it
            chunk.text = const_cast<char*>(text.c_str());
            chunk.itxt_length = text.size();
        }
        constexpr double METRES_PER_INCH = 0.0254;
        const auto per_metre = png_uint_32(std::lround(dots_per_inch_of(texts).value_or(0.0) / METRES_PER_INCH));
        png_.write = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, note_error, nullptr);
        png_.info = png_.write ? png_create_info_struct(png_.write) : nullptr;
        if (!png_.info) refuse();
        png_set_write_fn(png_.write, this, hand_on, nullptr);
        check(succeeds(png_.write, [&] {
            png_set_IHDR(png_.write, png_.info, png_uint_32(width), png_uint_32(height), 8, PNG_COLOR_TYPE_RGB_ALPHA,
                         PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
            png_set_sRGB(png_.write, png_.info, PNG_sRGB_INTENT_PERCEPTUAL);
            if (per_metre > 0) png_set_pHYs(png_.write, png_.info, per_metre, per_metre, PNG_RESOLUTION_METER);
            if (!chunks.empty()) png_set_text(png_.write, png_.info, chunks.data(), int(chunks.size()));
            png_write_info(png_.write, png_.info);
        }));
    }
    PngStream(const PngStream&) = delete;
    PngStream& operator=(const PngStream&) = delete;

    /// Adds the next row, 8-bit RGBA.
    void add(const uint8_t* row)
    {
        check(succeeds(png_.write, [&] { png_write_row(png_.write, row); }));
    }
    void end()
    {
        check(succeeds(png_.write, [&] { png_write_end(png_.write, png_.info); }));
    }

private:
    static void hand_on(png_structp png, png_bytep data, size_t bytes)
    {
        auto* const stream = static_cast<PngStream*>(png_get_io_ptr(png));
        if (!stream->takes({reinterpret_cast<const std::byte*>(data), bytes})) png_error(png, "stopped");
    }
    [[noreturn]] static void note_error(png_structp png, png_const_charp message)
    {
        auto* const stream = static_cast<PngStream*>(png_get_error_ptr(png));
        std::strncpy(stream->message_.data(), message, stream->message_.size() - 1);
        png_longjmp(png, 1);
    }
    bool takes(Bytes bytes) noexcept
    {
        try {
            take_(bytes);
            return true;
        } catch (...) {
            failure_ = std::current_exception();
            return false;
        }
    }
    void check(bool is_good)
    {
        if (is_good) return;
        if (failure_) std::rethrow_exception(failure_);
        refuse();
    }
    [[noreturn]] void refuse() { fail(name_, ": cannot be encoded as PNG: ", message_.data()); }

    std::string name_;
    Take take_;
    std::exception_ptr failure_;
    std::array<char, 128> message_{"memory is exhausted"};
    struct Handles {
        png_structp write = nullptr;
        png_infop info = nullptr;
        ~Handles() { png_destroy_write_struct(&write, &info); }
    } png_;
};

class PngWriter final : public ImageWriter {
public:
    PngWriter(const std::filesystem::path& path, int64_t width, int64_t height, const PictureTexts& texts = {})
        : width_(width),
          rows_left_(height),
          file_(path),
          png_(
              width, height, path.string(), [this](Bytes bytes) { file_.append(bytes); }, texts)
    {}
    void add_row(const uint8_t* row)
    {
        SHVR_CHECK(rows_left_-- > 0);
        png_.add(row);
    }
    void add(const ImageF& rows) override
    {
        SHVR_CHECK(rows.width == width_, rows.width, " != ", width_);
        row_.resize(4 * size_t(width_));
        for (size_t at = 0; at < rows.rgba.size(); at += row_.size()) {
            encode_pixels({&rows.rgba[at], row_.size()}, row_);
            add_row(row_.data());
        }
    }
    void commit() override
    {
        SHVR_CHECK(rows_left_ == 0, rows_left_);
        png_.end();
        file_.commit();
    }

private:
    int64_t width_, rows_left_;
    std::vector<uint8_t> row_;
    AtomicWriter file_;
    PngStream png_;
};

/// The format stores the bottom row first, so the first row added becomes the last row of the file.
class PfmWriter final : public ImageWriter {
public:
    PfmWriter(const std::filesystem::path& path, int64_t width, int64_t height)
        : width_(width), rows_left_(height), file_(path)
    {
        // The sign of the scale states the byte order; negative means little-endian.
        const char* scale = std::endian::native == std::endian::little ? "-1.0" : "1.0";
        const std::string header = sentence("PF\n", width, " ", height, "\n", scale, "\n");
        file_.write_at(0, std::as_bytes(std::span(header)));
        header_bytes_ = int64_t(header.size());
    }
    void add(const ImageF& rows) override
    {
        SHVR_CHECK(rows.width == width_, rows.width, " != ", width_);
        constexpr size_t CHANNELS = 3;
        row_.resize(CHANNELS * size_t(width_));
        const size_t row_values = 4 * size_t(width_);
        for (size_t begin = 0; begin < rows.rgba.size(); begin += row_values) {
            for (size_t x = 0; x < size_t(width_); ++x)
                std::copy_n(&rows.rgba[begin + 4 * x], CHANNELS, &row_[CHANNELS * x]);
            SHVR_CHECK(rows_left_-- > 0);
            const std::span<const std::byte> bytes = std::as_bytes(std::span(row_));
            file_.write_at(header_bytes_ + rows_left_ * int64_t(bytes.size()), bytes);
        }
    }
    void commit() override
    {
        SHVR_CHECK(rows_left_ == 0, rows_left_);
        file_.commit();
    }

private:
    int64_t width_, rows_left_, header_bytes_ = 0;
    std::vector<float> row_;
    AtomicWriter file_;
};

}  // namespace

std::optional<double> dots_per_inch_of(const PictureTexts& texts)
{
    for (const auto& [keyword, text] : texts)
        if (keyword == PICTURE_DPI) return number_of(text);
    return {};
}

Image8 decode_png(Bytes file, std::string_view name)
{
    check_file(file, name);
    PngImage png;
    if (png_image_begin_read_from_memory(&png.image, file.data(), file.size()) == 0) {
        fail(name, ": is not a valid PNG file: ", png.image.message);
    }
    png.image.format = PNG_FORMAT_RGBA;
    // Without this flag, libpng takes 16-bit files without a gAMA chunk as linear, which hardly any such file is.
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
    const size_t row_bytes = 4 * size_t(image.width), bytes = row_bytes * size_t(image.height);
    SHVR_CHECK(image.rgba.size() == bytes, image.rgba.size(), " != ", bytes);
    std::vector<std::byte> file;
    PngStream png(image.width, image.height, name,
                  [&](Bytes more) { file.insert(file.end(), more.begin(), more.end()); });
    for (size_t at = 0; at < bytes; at += row_bytes) png.add(&image.rgba[at]);
    png.end();
    return file;
}

Image8 read_png(const std::filesystem::path& path)
{
    return decode_png(read_file(path, MAX_PNG_BYTES), path.string());
}

namespace {

/// Reads the chunks before the pixels.
class PngTexts {
public:
    PngTexts(std::istream& file, std::string_view name) : name_(name), file_(file)
    {
        handles_.read = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, note_error, nullptr);
        handles_.info = handles_.read ? png_create_info_struct(handles_.read) : nullptr;
        if (!handles_.info) refuse();
        png_set_read_fn(handles_.read, this, hand_out);
        png_set_user_limits(handles_.read, png_uint_32(MAX_IMAGE_SIDE), png_uint_32(MAX_IMAGE_SIDE));
        png_set_chunk_malloc_max(handles_.read, MAX_PICTURE_TEXT + 4096);
        // Makes libpng report damaged text as an error instead of skipping it.
        png_set_benign_errors(handles_.read, 0);
        png_set_crc_action(handles_.read, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
        if (!succeeds(handles_.read, [&] { png_read_info(handles_.read, handles_.info); })) refuse();
    }
    PngTexts(const PngTexts&) = delete;
    PngTexts& operator=(const PngTexts&) = delete;

    std::optional<std::string> text(std::string_view keyword) const
    {
        png_textp texts = nullptr;
        const int count = png_get_text(handles_.read, handles_.info, &texts, nullptr);
        for (int i = 0; i < count; ++i) {
            const png_text& each = texts[i];
            if (keyword != each.key) continue;
            return std::string(each.text, each.compression > 0 ? each.itxt_length : each.text_length);
        }
        return std::nullopt;
    }

private:
    static void hand_out(png_structp png, png_bytep data, size_t bytes)
    {
        auto* const texts = static_cast<PngTexts*>(png_get_io_ptr(png));
        if (!texts->file_.read(reinterpret_cast<char*>(data), std::streamsize(bytes)))
            png_error(png, "it ends in the midst of a chunk");
    }
    [[noreturn]] static void note_error(png_structp png, png_const_charp message)
    {
        auto* const texts = static_cast<PngTexts*>(png_get_error_ptr(png));
        std::strncpy(texts->message_.data(), message, texts->message_.size() - 1);
        png_longjmp(png, 1);
    }
    [[noreturn]] void refuse() const { fail(name_, ": its texts cannot be read: ", message_.data()); }

    std::string name_;
    std::istream& file_;
    std::array<char, 128> message_{"memory is exhausted"};
    struct Handles {
        png_structp read = nullptr;
        png_infop info = nullptr;
        ~Handles() { png_destroy_read_struct(&read, &info, nullptr); }
    } handles_;
};

}  // namespace

std::optional<std::string> read_png_text(const std::filesystem::path& path, std::string_view keyword)
{
    if (!is_file(path)) return std::nullopt;
    std::ifstream file(path, std::ios::binary);
    std::array<char, SIGNATURE_BYTES> signature{};
    const bool is_png = file.read(signature.data(), signature.size()) &&
                        png_sig_cmp(reinterpret_cast<png_const_bytep>(signature.data()), 0, signature.size()) == 0;
    if (!is_png) return std::nullopt;
    file.seekg(0);
    return PngTexts(file, path.string()).text(keyword);
}

void write_png(const std::filesystem::path& path, const Image8& image, const PictureTexts& texts)
{
    check_size(image.width, image.height, path.string());
    const size_t row_bytes = 4 * size_t(image.width), bytes = row_bytes * size_t(image.height);
    SHVR_CHECK(image.rgba.size() == bytes, image.rgba.size(), " != ", bytes);
    PngWriter writer(path, image.width, image.height, texts);
    for (size_t at = 0; at < bytes; at += row_bytes) writer.add_row(&image.rgba[at]);
    writer.commit();
}

void write_pfm(const std::filesystem::path& path, const ImageF& image)
{
    check_size(image.width, image.height, path.string());
    PfmWriter writer(path, image.width, image.height);
    writer.add(image);
    writer.commit();
}

std::unique_ptr<ImageWriter> image_writer(const std::filesystem::path& path, int64_t width, int64_t height,
                                          const PictureTexts& texts)
{
    const auto is_side = [](int64_t pixels) { return pixels >= 1 && pixels <= MAX_IMAGE_SIDE; };
    if (!is_side(width) || !is_side(height))
        fail(path.string(), ": the picture is ", width, " x ", height, " pixels; expected 1 to ", MAX_IMAGE_SIDE,
             " along each side");
    if (lower_case(path.extension().string()) == ".pfm") return std::make_unique<PfmWriter>(path, width, height);
    if (is_tiff_name(path)) return tiff_writer(path, width, height, texts);
    return std::make_unique<PngWriter>(path, width, height, texts);
}

}  // namespace shvr
