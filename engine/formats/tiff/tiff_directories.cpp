// Walks the chain of directories. A directory has a count, as many fields of 12 (BigTIFF: 20) bytes, and the offset of
// the next directory. A field has a tag, a type, a count and a value or, if the value is longer than 4 (BigTIFF: 8)
// bytes, the value's offset (TIFF 6.0 specification, section 2).

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/tiff/tiff_file.h"
#include "engine/formats/tiff/tiff_numbers.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

/// Maximum number of fields, as in libtiff: a larger count probably comes from a wrong offset.
constexpr uint64_t MAX_FIELDS = 4096;

enum Tag : uint16_t {
    NEW_SUBFILE_TYPE = 254,
    SUBFILE_TYPE = 255,
    IMAGE_WIDTH = 256,
    IMAGE_LENGTH = 257,
    BITS_PER_SAMPLE = 258,
    COMPRESSION = 259,
    SAMPLES_PER_PIXEL = 277,
    STRIP_OFFSETS = 273,
    STRIP_BYTE_COUNTS = 279,
    TILE_OFFSETS = 324,
    TILE_BYTE_COUNTS = 325,
};

/// Tags whose values must be equal in pages of one kind: subfile types, size, bits, compression, meaning, order of
/// bits, orientation, samples, rows of a strip, planes, fax options, predictor, tiles, extra samples, sample format,
/// sub-sampling.
constexpr std::array<bool, 531> TELLS_KIND = [] {
    std::array<bool, 531> tells{};
    for (const int tag :
         {254, 255, 256, 257, 258, 259, 262, 266, 274, 277, 278, 284, 292, 293, 317, 322, 323, 338, 339, 530}) {
        tells[size_t(tag)] = true;
    }
    return tells;
}();

size_t bytes_of_type(uint16_t type)
{
    constexpr uint8_t BYTES[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    return type < std::size(BYTES) ? BYTES[type] : 0;
}

struct Field {
    uint16_t tag = 0;
    uint16_t type = 0;
    uint64_t count = 0;
    const std::byte* value = nullptr;  ///< 4 or 8 bytes
};

/// A buffered window into the file, which combines many small reads into one.
class Window {
public:
    explicit Window(const TiffFile& file) : file_(file) {}

    /// Returns null if the file does not hold that many bytes at `offset`. The pointer is valid until the next call.
    const std::byte* at(uint64_t offset, size_t bytes)
    {
        if (!file_.holds(offset, bytes)) return nullptr;
        if (offset < begin_ || offset - begin_ + bytes > held_.size()) {
            held_.resize(std::max(SIZE, bytes));
            held_.resize(file_.read_some(int64_t(offset), held_));
            begin_ = offset;
            if (held_.size() < bytes) return nullptr;  // truncated meanwhile
        }
        return held_.data() + (offset - begin_);
    }

private:
    static constexpr size_t SIZE = 4096;

    const TiffFile& file_;
    uint64_t begin_ = 0;
    std::vector<std::byte> held_;
};

/// Reads directories, one at a time, in any order.
class Reader {
public:
    explicit Reader(const TiffFile& file)
        : file_(file),
          window_(file),
          count_bytes_(file.has_wide_offsets() ? 8 : 2),
          field_bytes_(file.has_wide_offsets() ? 20 : 12),
          offset_bytes_(file.has_wide_offsets() ? 8 : 4)
    {}

    /// Reads the directory at `offset` for fields() and next(). `page` counts from 1 and is only used in messages.
    void read(uint64_t offset, size_t page)
    {
        const auto refuse = [&](const auto&... words) { fail(file_.path().string(), ": page ", page, words...); };
        const std::byte* start = window_.at(offset, count_bytes_);
        if (start == nullptr) {
            refuse(" starts at byte ", offset, "; expected less than the ", file_.size_bytes(),
                   " bytes of the file: it is truncated or damaged");
        }
        const uint64_t count = number(start, count_bytes_);
        if (count == 0 || count > MAX_FIELDS) {
            refuse(" has a directory of ", count, " fields; expected 1 to ", MAX_FIELDS);
        }
        size_t bytes = count_bytes_ + size_t(count) * field_bytes_ + offset_bytes_;
        start = window_.at(offset, bytes);
        // Some files end right after the last directory's fields, without the offset of a next directory.
        lacks_next_ = start == nullptr && offset + bytes - offset_bytes_ == uint64_t(file_.size_bytes());
        if (lacks_next_) bytes -= offset_bytes_;
        if (lacks_next_) start = window_.at(offset, bytes);
        if (start == nullptr) {
            refuse(" has a directory that ends at byte ", offset + bytes, "; expected at most the ", file_.size_bytes(),
                   " bytes of the file: it is truncated or damaged");
        }
        fields_ = start + count_bytes_;
        count_ = size_t(count);
        next_ = lacks_next_ ? 0 : number(fields_ + count_ * field_bytes_, offset_bytes_);
        bytes_ = bytes;
    }

    size_t count() const { return count_; }
    uint64_t next() const { return next_; }          ///< 0: this directory is the last one
    bool lacks_next() const { return lacks_next_; }  ///< the file ends before the offset of the next directory
    size_t bytes() const { return bytes_; }

    Field field(size_t index) const
    {
        const std::byte* const at = fields_ + index * field_bytes_;
        return {uint16_t(number(at, 2)), uint16_t(number(at + 2, 2)), number(at + 4, field_bytes_ - offset_bytes_ - 4),
                at + field_bytes_ - offset_bytes_};
    }
    bool is_inside(const Field& field) const
    {
        return field.count <= offset_bytes_ && field.count * bytes_of_type(field.type) <= offset_bytes_;
    }
    /// Returns the field's value if it is one number that fits into the field, otherwise the offset of its values.
    uint64_t value(const Field& field) const
    {
        const size_t bytes = bytes_of_type(field.type);
        return number(field.value, field.count == 1 && bytes > 0 && bytes <= offset_bytes_ ? bytes : offset_bytes_);
    }

private:
    uint64_t number(const std::byte* bytes, size_t count) const
    {
        return tiff_number(bytes, count, file_.is_big_endian());
    }

    const TiffFile& file_;
    Window window_;
    size_t count_bytes_, field_bytes_, offset_bytes_;
    const std::byte* fields_ = nullptr;
    size_t count_ = 0;
    uint64_t next_ = 0;
    bool lacks_next_ = false;
    size_t bytes_ = 0;
};

const char* name_of_tag(uint16_t tag)
{
    if (tag == STRIP_OFFSETS) return "StripOffsets";
    if (tag == STRIP_BYTE_COUNTS) return "StripByteCounts";
    return tag == TILE_OFFSETS ? "TileOffsets" : "TileByteCounts";
}

/// Checks the strips or tiles that directories state, as far as possible without further reads.
class StripCheck {
public:
    explicit StripCheck(const TiffFile& file) : file_(file) {}

    void look_at(const Field& field, const Reader& reader, size_t page)
    {
        look_at_picture(field, reader);
        if (field.tag != STRIP_OFFSETS && field.tag != STRIP_BYTE_COUNTS && field.tag != TILE_OFFSETS &&
            field.tag != TILE_BYTE_COUNTS)
            return;
        const uint64_t value = reader.value(field);
        if (!reader.is_inside(field)) {
            const size_t bytes = bytes_of_type(field.type);
            if (bytes != 0 && field.count <= uint64_t(file_.size_bytes()) && file_.holds(value, field.count * bytes))
                return;
            fail(file_.path().string(), ": page ", page, ": ", name_of_tag(field.tag), " has ", field.count,
                 " values at byte ", value, "; expected as many as fit into the ", file_.size_bytes(),
                 " bytes of the file");
        }
        if (field.count != 1) return;
        (field.tag == STRIP_OFFSETS || field.tag == TILE_OFFSETS ? offset_ : bytes_) = value;
    }

    /// Checks the last directory. Returns true if it states too many bytes for the file, but its pixels are all there.
    bool finish(size_t page)
    {
        const bool states_too_many = !file_.holds(offset_, bytes_) && picture_.bytes() < bytes_;
        if (states_too_many) bytes_ = picture_.bytes();
        picture_ = {};
        if (!file_.holds(offset_, bytes_)) {
            fail(file_.path().string(), ": page ", page, ": its voxels are ", bytes_, " bytes at byte ", offset_,
                 " by StripOffsets and StripByteCounts; expected them within the ", file_.size_bytes(),
                 " bytes of the file");
        }
        sum_ += bytes_;
        if (sum_ > uint64_t(file_.size_bytes())) {
            fail(file_.path().string(), ": pages 1 to ", page, " state ", sum_,
                 " bytes of voxels in StripByteCounts; expected at most the ", file_.size_bytes(),
                 " bytes of the file: their strips overlap");
        }
        offset_ = bytes_ = 0;
        return states_too_many;
    }

private:
    struct Picture {
        uint64_t width = 0, length = 0, bits = 1, samples = 1, compression = 1;
        /// Returns the size in bytes of an uncompressed page in a single strip; UINT64_MAX if the size is unknown.
        uint64_t bytes() const
        {
            uint64_t row_bits = 0, bytes = 0;
            const bool overflows = __builtin_mul_overflow(width * samples, bits, &row_bits) ||
                                   __builtin_mul_overflow((row_bits + 7) / 8, length, &bytes);
            return compression != 1 || bytes == 0 || overflows ? UINT64_MAX : bytes;
        }
    };

    void look_at_picture(const Field& field, const Reader& reader)
    {
        // The bit depths of several samples are stored outside the field, and only libtiff reads them: 0 means unknown.
        const uint64_t value = field.count == 1 ? reader.value(field) : 0;
        if (field.tag == IMAGE_WIDTH) picture_.width = value;
        if (field.tag == IMAGE_LENGTH) picture_.length = value;
        if (field.tag == BITS_PER_SAMPLE) picture_.bits = value;
        if (field.tag == COMPRESSION) picture_.compression = value;
        if (field.tag == SAMPLES_PER_PIXEL) picture_.samples = value;
    }

    const TiffFile& file_;
    Picture picture_;
    uint64_t offset_ = 0;
    uint64_t bytes_ = 0;
    uint64_t sum_ = 0;
};

class KindFinder {
public:
    void look_at(const Field& field, const Reader& reader)
    {
        if (field.tag >= TELLS_KIND.size() || !TELLS_KIND[field.tag]) return;
        const uint64_t value = reader.is_inside(field) ? reader.value(field) : OUTSIDE;
        const uint64_t parts[] = {field.tag, field.count, value};
        fields_.append(reinterpret_cast<const char*>(parts), sizeof(parts));
        if (field.tag == NEW_SUBFILE_TYPE) is_reduced_ |= (value & 1) != 0 || (value & 4) != 0;
        if (field.tag == SUBFILE_TYPE) is_reduced_ |= value == 2;
        if (field.tag == IMAGE_WIDTH) width_ = value;
        if (field.tag == IMAGE_LENGTH) length_ = value;
    }

    /// Returns the kind of the directory whose fields were added since the last call.
    uint32_t finish(const TiffFile& file, std::vector<TiffKind>& kinds, size_t page)
    {
        check_side(file, page, "ImageWidth", width_);
        check_side(file, page, "ImageLength", length_);
        // Skips the search if the page has the same fields as the previous one, as most pages do.
        if (last_ >= kinds.size() || kinds[last_].fields != fields_) {
            const auto found =
                std::find_if(kinds.begin(), kinds.end(), [&](const TiffKind& kind) { return kind.fields == fields_; });
            last_ = size_t(found - kinds.begin());
            if (found == kinds.end()) kinds.push_back({page - 1, is_reduced_, fields_});
            if (kinds.size() > MAX_KINDS) {
                fail(file.path().string(), ": its first ", page, " pages differ in ", kinds.size(),
                     " ways; expected pages of one layout: save those of one layout as a file of their own");
            }
        }
        fields_.clear();
        is_reduced_ = false;
        width_.reset();
        length_.reset();
        return uint32_t(last_);
    }

private:
    static constexpr size_t MAX_KINDS = 64;
    static constexpr uint64_t OUTSIDE = ~uint64_t{0};

    static void check_side(const TiffFile& file, size_t page, const char* name, const std::optional<uint64_t>& side)
    {
        if (side && *side >= 1 && *side <= uint64_t{MAX_SIDE}) return;
        const bool is_there = side && *side != OUTSIDE;
        fail(file.path().string(), ": page ", page, ": ", name, " is ",
             is_there ? std::to_string(*side)
             : side   ? "not within the file"
                      : "missing",
             "; expected 1 to ", MAX_SIDE);
    }

    std::string fields_;
    bool is_reduced_ = false;
    std::optional<uint64_t> width_, length_;
    size_t last_ = 0;
};

}  // namespace

TiffDirectories read_directories(const TiffFile& file)
{
    TiffDirectories directories;
    Reader reader(file);
    StripCheck strips(file);
    KindFinder kind;
    uint64_t directory_bytes = 0;
    bool warned_of_bytes = false;
    // Detects cycles (Brent): remembers the offset of one page, and replaces it at every power of two.
    uint64_t remembered = 0;
    for (uint64_t offset = file.first_directory(); offset != 0; offset = reader.next()) {
        const size_t page = directories.pages.size() + 1;
        if (page > MAX_TIFF_PAGES) {
            fail(file.path().string(), ": holds more than ", MAX_TIFF_PAGES, " pages; expected at most that many");
        }
        if (offset == remembered) {
            fail(file.path().string(), ": page ", page, " starts where an earlier page does, at byte ", offset,
                 "; expected a chain of pages that ends");
        }
        if ((page & (page - 1)) == 0) remembered = offset;
        reader.read(offset, page);
        directory_bytes += reader.bytes();
        if (directory_bytes > uint64_t(file.size_bytes())) {
            fail(file.path().string(), ": the directories of pages 1 to ", page, " take ", directory_bytes,
                 " bytes; expected at most the ", file.size_bytes(), " bytes of the file: they overlap");
        }
        for (size_t i = 0; i < reader.count(); ++i) {
            const Field field = reader.field(i);
            kind.look_at(field, reader);
            strips.look_at(field, reader, page);
        }
        if (strips.finish(page) && !warned_of_bytes) {
            warned_of_bytes = true;
            directories.warnings.push_back(sentence("page ", page,
                                                    " states more bytes in StripByteCounts than the file holds; those "
                                                    "that its pixels take were read"));
        }
        if (reader.lacks_next())
            directories.warnings.push_back(sentence(
                "the directory of page ", page, " was cut before the offset of a next one; it was taken as the last"));
        directories.pages.push_back({offset, kind.finish(file, directories.kinds, page)});
    }
    if (directories.pages.empty()) fail(file.path().string(), ": has no pages; expected at least one");
    return directories;
}

std::optional<double> rational_field(const TiffFile& file, uint64_t offset, uint16_t tag)
{
    constexpr uint16_t RATIONAL = 5;
    Reader reader(file);
    reader.read(offset, 1);
    for (size_t i = 0; i < reader.count(); ++i) {
        const Field field = reader.field(i);
        if (field.tag != tag || field.type != RATIONAL || field.count != 1) continue;
        std::array<std::byte, 8> bytes{};
        if (reader.is_inside(field)) {
            std::copy_n(field.value, bytes.size(), bytes.begin());
        } else {
            const uint64_t at = reader.value(field);
            if (!file.holds(at, bytes.size())) return {};
            file.read(int64_t(at), bytes);
        }
        const uint64_t above = tiff_number(bytes.data(), 4, file.is_big_endian());
        const uint64_t below = tiff_number(bytes.data() + 4, 4, file.is_big_endian());
        if (above == 0 || below == 0) return {};
        return double(above) / double(below);
    }
    return {};
}

bool has_field(const TiffFile& file, uint64_t offset, uint16_t tag)
{
    Reader reader(file);
    reader.read(offset, 1);
    for (size_t i = 0; i < reader.count(); ++i) {
        if (reader.field(i).tag == tag) return true;
    }
    return false;
}

}  // namespace shvr
