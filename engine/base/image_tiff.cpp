#include "engine/base/image_tiff.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

// Offsets have 32 bits, and strips are written twice if alpha turns up late.
constexpr int64_t MAX_TIFF_PIXELS = 4'000'000'000 / (3 + 4);
constexpr int64_t STRIP_BYTES = 1 << 18;
constexpr size_t HEADER_BYTES = 8, ENTRY_BYTES = 12, RGBA = 4, RGB = 3;
constexpr uint32_t FIRST_BYTES = 0x002a4949;  // "II", little-endian, and 42

enum Tag : uint16_t {
    WIDTH = 256,
    HEIGHT = 257,
    BITS = 258,
    COMPRESSION = 259,
    PHOTOMETRIC = 262,
    DESCRIPTION = 270,
    STRIP_OFFSETS = 273,
    SAMPLES = 277,
    ROWS_PER_STRIP = 278,
    STRIP_SIZES = 279,
    X_RESOLUTION = 282,
    Y_RESOLUTION = 283,
    PLANES = 284,
    RESOLUTION_UNIT = 296,
    SOFTWARE = 305,
    PREDICTOR = 317,
    EXTRA_SAMPLES = 338
};
enum Type : uint16_t { ASCII = 2, SHORT = 3, LONG = 4, RATIONAL = 5 };

void put(std::vector<std::byte>& to, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i) to.push_back(std::byte(value >> (8 * i)));
}

uint32_t number_at(std::span<const std::byte> bytes, size_t at, int count)
{
    uint32_t number = 0;
    for (int i = 0; i < count; ++i) number |= std::to_integer<uint32_t>(bytes[at + size_t(i)]) << (8 * i);
    return number;
}

/// The directory of the file's only image. Entries are added in the order of their tags.
class Directory {
public:
    /// `at`: offset of the directory in the file.
    Directory(int64_t at, size_t entries) : more_at_(at + 2 + int64_t(entries * ENTRY_BYTES) + 4)
    {
        put(bytes_, entries, 2);
    }
    void add(Tag tag, Type type, const std::vector<uint32_t>& values)
    {
        std::vector<std::byte> stored;
        for (const uint32_t value : values) put(stored, value, type == ASCII ? 1 : type == SHORT ? 2 : 4);
        put(bytes_, tag, 2);
        put(bytes_, type, 2);
        put(bytes_, type == RATIONAL ? values.size() / 2 : values.size(), 4);
        if (stored.size() <= 4) {
            stored.resize(4);
            bytes_.insert(bytes_.end(), stored.begin(), stored.end());
            return;
        }
        put(bytes_, uint64_t(more_at_) + more_.size(), 4);
        more_.insert(more_.end(), stored.begin(), stored.end());
        if (more_.size() % 2 != 0) more_.push_back({});
    }
    void add(Tag tag, const std::string& text)
    {
        std::vector<uint32_t> letters;
        for (const char letter : text) letters.push_back(uint8_t(letter));
        letters.push_back(0);
        add(tag, ASCII, letters);
    }
    std::vector<std::byte> take()
    {
        put(bytes_, 0, 4);  // no image follows
        bytes_.insert(bytes_.end(), more_.begin(), more_.end());
        return std::move(bytes_);
    }

private:
    int64_t more_at_;
    std::vector<std::byte> bytes_, more_;
};

class TiffPicture final : public ImageWriter {
public:
    TiffPicture(const std::filesystem::path& path, int64_t width, int64_t height, const PictureTexts& texts)
        : path_(path),
          width_(width),
          height_(height),
          strip_rows_(std::clamp<int64_t>(STRIP_BYTES / (width * int64_t(RGBA)), 1, height)),
          texts_(texts),
          file_(path)
    {
        if (width * height > MAX_TIFF_PIXELS)
            fail(path.string(), ": the picture is ", width, " x ", height, " pixels; expected at most ",
                 MAX_TIFF_PIXELS, " of them in a TIFF: choose a name that ends in .png");
        const std::vector<std::byte> header(HEADER_BYTES);
        write(header);
    }
    void add(const ImageF& rows) override
    {
        SHVR_CHECK(rows.width == width_, rows.width, " != ", width_);
        const size_t row_values = RGBA * size_t(width_);
        for (size_t at = 0; at < rows.rgba.size(); at += row_values) {
            SHVR_CHECK(rows_ < height_, rows_);
            const size_t begin = strip_.size();
            strip_.resize(begin + row_values);
            encode_pixels({&rows.rgba[at], row_values}, {&strip_[begin], row_values});
            if (++rows_ % strip_rows_ == 0 || rows_ == height_) end_strip();
        }
    }
    void commit() override
    {
        SHVR_CHECK(rows_ == height_, rows_, " of ", height_);
        const int64_t at = end_ + end_ % 2;
        file_.write_at(at, directory(at));
        std::vector<std::byte> header;
        put(header, FIRST_BYTES, 4);
        put(header, uint64_t(at), 4);
        file_.write_at(0, header);
        file_.commit();
    }

private:
    void write(std::span<const std::byte> bytes)
    {
        file_.write_at(end_, bytes);
        end_ += int64_t(bytes.size());
    }
    size_t samples() const { return has_alpha_ ? RGBA : RGB; }
    void end_strip()
    {
        bool is_opaque = true;
        for (size_t at = RGB; at < strip_.size(); at += RGBA) is_opaque = is_opaque && strip_[at] == 255;
        if (!is_opaque && !has_alpha_) add_alpha();
        write_strip(strip_);
        strip_.clear();
    }
    /// Writes pixels of RGBA: each as its difference from the one at its left, deflated.
    void write_strip(const std::vector<uint8_t>& pixels)
    {
        const size_t count = pixels.size() / RGBA;
        std::vector<uint8_t> values(count * samples());
        for (size_t i = 0; i < count; ++i)
            for (size_t c = 0; c < samples(); ++c) {
                const uint8_t left = i % size_t(width_) == 0 ? 0 : pixels[RGBA * (i - 1) + c];
                values[samples() * i + c] = uint8_t(pixels[RGBA * i + c] - left);
            }
        uLongf bytes = compressBound(uLong(values.size()));
        std::vector<std::byte> deflated(bytes);
        const int result = compress2(reinterpret_cast<Bytef*>(deflated.data()), &bytes, values.data(),
                                     uLong(values.size()), Z_DEFAULT_COMPRESSION);
        SHVR_CHECK(result == Z_OK, result);
        offsets_.push_back(uint32_t(end_));
        sizes_.push_back(uint32_t(bytes));
        write(std::span(deflated).first(bytes));
    }
    /// Writes the strips again, which were opaque so far.
    void add_alpha()
    {
        const std::vector<uint32_t> offsets = std::move(offsets_), sizes = std::move(sizes_);
        offsets_.clear();
        sizes_.clear();
        has_alpha_ = true;
        const size_t count = size_t(width_ * strip_rows_);
        std::vector<uint8_t> values(count * RGB), pixels(count * RGBA, 255);
        for (size_t strip = 0; strip < offsets.size(); ++strip) {
            std::vector<std::byte> deflated(sizes[strip]);
            file_.read_back(int64_t(offsets[strip]), deflated);
            uLongf bytes = uLongf(values.size());
            const int result = uncompress(values.data(), &bytes, reinterpret_cast<const Bytef*>(deflated.data()),
                                          uLong(deflated.size()));
            SHVR_CHECK(result == Z_OK && bytes == values.size(), result);
            for (size_t i = 0; i < count; ++i)
                for (size_t c = 0; c < RGB; ++c) {
                    const uint8_t left = i % size_t(width_) == 0 ? 0 : pixels[RGBA * (i - 1) + c];
                    pixels[RGBA * i + c] = uint8_t(values[RGB * i + c] + left);
                }
            write_strip(pixels);
        }
    }
    std::vector<std::byte> directory(int64_t at) const
    {
        std::string description;
        for (const auto& [keyword, text] : texts_)
            description += (description.empty() ? "" : std::string(1, '\0')) + keyword + '\n' + text;
        const std::optional<double> dpi = dots_per_inch_of(texts_);
        const size_t entries = 12 + size_t(!description.empty()) + (dpi ? 3 : 0) + size_t(has_alpha_);
        Directory to(at, entries);
        to.add(WIDTH, LONG, {uint32_t(width_)});
        to.add(HEIGHT, LONG, {uint32_t(height_)});
        to.add(BITS, SHORT, std::vector<uint32_t>(samples(), 8));
        to.add(COMPRESSION, SHORT, {8});  // deflate
        to.add(PHOTOMETRIC, SHORT, {2});  // RGB
        if (!description.empty()) to.add(DESCRIPTION, description);
        to.add(STRIP_OFFSETS, LONG, offsets_);
        to.add(SAMPLES, SHORT, {uint32_t(samples())});
        to.add(ROWS_PER_STRIP, LONG, {uint32_t(strip_rows_)});
        to.add(STRIP_SIZES, LONG, sizes_);
        if (dpi) {
            constexpr uint32_t PARTS = 1000;
            const std::vector<uint32_t> resolution{uint32_t(std::lround(*dpi * PARTS)), PARTS};
            to.add(X_RESOLUTION, RATIONAL, resolution);
            to.add(Y_RESOLUTION, RATIONAL, resolution);
        }
        to.add(PLANES, SHORT, {1});
        if (dpi) to.add(RESOLUTION_UNIT, SHORT, {2});  // inches
        to.add(SOFTWARE, "SHVR");
        to.add(PREDICTOR, SHORT, {2});                      // differences
        if (has_alpha_) to.add(EXTRA_SAMPLES, SHORT, {2});  // straight alpha
        return to.take();
    }

    std::filesystem::path path_;
    int64_t width_, height_, strip_rows_, rows_ = 0, end_ = 0;
    PictureTexts texts_;
    bool has_alpha_ = false;
    std::vector<uint8_t> strip_;  ///< rows that wait for the rest of their strip, RGBA
    std::vector<uint32_t> offsets_, sizes_;
    AtomicWriter file_;
};

/// Reads bytes of a file at an offset; empty if the file does not have them.
std::vector<std::byte> bytes_at(std::ifstream& file, uint64_t offset, size_t count)
{
    std::vector<std::byte> bytes(count);
    file.clear();
    file.seekg(std::streamoff(offset));
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(count))) return {};
    return bytes;
}

/// Returns the image description of the first image; empty if the file is no little-endian TIFF with one.
std::string description_of(const std::filesystem::path& path)
{
    constexpr size_t MAX_DESCRIPTION = 2 * MAX_PICTURE_TEXT;
    std::ifstream file(path, std::ios::binary);
    const std::vector<std::byte> header = bytes_at(file, 0, HEADER_BYTES);
    if (header.empty() || number_at(header, 0, 4) != FIRST_BYTES) return {};
    const uint64_t at = number_at(header, 4, 4);
    const std::vector<std::byte> count = bytes_at(file, at, 2);
    if (count.empty()) return {};
    const std::vector<std::byte> entries = bytes_at(file, at + 2, number_at(count, 0, 2) * ENTRY_BYTES);
    for (size_t entry = 0; entry < entries.size(); entry += ENTRY_BYTES) {
        if (number_at(entries, entry, 2) != DESCRIPTION || number_at(entries, entry + 2, 2) != ASCII) continue;
        const size_t letters = number_at(entries, entry + 4, 4);
        if (letters <= 4 || letters > MAX_DESCRIPTION) return {};
        const std::vector<std::byte> text = bytes_at(file, number_at(entries, entry + 8, 4), letters);
        return text.empty() ? std::string() : std::string(reinterpret_cast<const char*>(text.data()), letters - 1);
    }
    return {};
}

}  // namespace

bool is_tiff_name(const std::filesystem::path& path)
{
    const std::string extension = lower_case(path.extension().string());
    return extension == ".tif" || extension == ".tiff";
}

std::unique_ptr<ImageWriter> tiff_writer(const std::filesystem::path& path, int64_t width, int64_t height,
                                         const PictureTexts& texts)
{
    return std::make_unique<TiffPicture>(path, width, height, texts);
}

std::optional<std::string> read_tiff_text(const std::filesystem::path& path, std::string_view keyword)
{
    if (!is_file(path)) return std::nullopt;
    const std::string description = description_of(path), begin = std::string(keyword) + '\n';
    for (size_t at = 0; at < description.size();) {
        const size_t end = std::min(description.find('\0', at), description.size());
        const std::string_view each = std::string_view(description).substr(at, end - at);
        if (each.starts_with(begin)) return std::string(each.substr(begin.size()));
        at = end + 1;
    }
    return std::nullopt;
}

}  // namespace shvr
