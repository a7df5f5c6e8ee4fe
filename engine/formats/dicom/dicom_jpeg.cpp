#include "engine/formats/dicom/dicom_jpeg.h"

#include <algorithm>
#include <string_view>

#include "engine/base/error.h"

namespace shvr {
namespace {

constexpr std::string_view PREFIX = "1.2.840.10008.1.2.4.";  ///< prefix of the UIDs of all JPEG transfer syntaxes

enum Marker : uint8_t {
    TEM = 0x01,
    BASELINE = 0xc0,
    EXTENDED = 0xc1,
    PROGRESSIVE = 0xc2,
    LOSSLESS = 0xc3,
    HUFFMAN_TABLES = 0xc4,
    RESERVED_FRAME = 0xc8,
    ARITHMETIC_TABLES = 0xcc,
    LAST_FRAME = 0xcf,
    RESTART = 0xd0,
    START = 0xd8,
    END = 0xd9,
    SCAN = 0xda,
    JFIF = 0xe0,
    LS_FRAME = 0xf7  ///< ITU-T T.87
};

struct Size {
    int64_t columns, rows, components;
};

void check_size(const InputFile& file, const Size& found, int64_t columns, int64_t rows)
{
    if (found.columns != columns || found.rows != rows || found.components != 1)
        fail(file.path.string(), ": a JPEG picture has ", found.columns, "x", found.rows, " pixels of ",
             found.components, " components; expected ", columns, "x", rows, " of one, as the file's header says");
}

class Header {
public:
    Header(const InputFile& file, const DicomLayout::Fragment& fragment)
        : file_(file), at_(fragment.at), end_(fragment.at + fragment.bytes)
    {}

    bool begins() const { return end_ - at_ >= 2 && byte(at_) == 0xff && byte(at_ + 1) == START; }

    void check(int64_t columns, int64_t rows)
    {
        at_ += 2;
        for (bool has_frame = false;;) {
            const int64_t marker_at = at_;
            const uint8_t marker = next_marker();
            if (marker == TEM) continue;
            if (marker == END || marker == START || (marker >= RESTART && marker < START))
                refuse("ends before its pixels", marker_at);
            const int64_t length = end_ - at_ >= 2 ? number(at_) : 0;
            if (length < 2 || length > end_ - at_) refuse("has a segment with a wrong length", marker_at);
            if (is_frame(marker)) check_frame(marker, length, columns, rows);
            has_frame = has_frame || is_frame(marker);
            if (marker == JFIF && length >= 16 && names_jfif(at_ + 2) && byte(at_ + 7) != 1)
                refuse("is of an unknown version of JFIF", marker_at);
            if (marker == SCAN && !has_frame) refuse("has no frame before its pixels", marker_at);
            if (marker == SCAN) return;
            at_ += length;
        }
    }

private:
    static bool is_frame(uint8_t marker)
    {
        return marker == LS_FRAME || (marker >= BASELINE && marker <= LAST_FRAME && marker != HUFFMAN_TABLES &&
                                      marker != RESERVED_FRAME && marker != ARITHMETIC_TABLES);
    }

    [[noreturn]] void refuse(std::string_view what, int64_t at) const
    {
        fail(file_.path.string(), ": a JPEG picture ", what, " at byte ", at,
             "; expected a header as ITU-T T.81 or T.87 defines it");
    }

    uint8_t byte(int64_t at) const
    {
        std::array<std::byte, 1> one{};
        return file_.read_some(at, one) == 1 ? std::to_integer<uint8_t>(one[0]) : uint8_t(0);
    }
    int64_t number(int64_t at) const { return byte(at) << 8 | byte(at + 1); }
    bool names_jfif(int64_t at) const
    {
        std::array<char, 5> name{};
        file_.read_some(at, std::as_writable_bytes(std::span(name)));
        return std::string_view(name.data(), 5) == std::string_view("JFIF\0", 5);
    }

    /// Skips fill bytes 0xff and returns the next marker.
    uint8_t next_marker()
    {
        const int64_t begin = at_;
        while (at_ < end_ && byte(at_) == 0xff) ++at_;
        if (at_ == begin || at_ >= end_ || byte(at_) == 0) refuse("has no marker", begin);
        return byte(at_++);
    }

    void check_frame(uint8_t marker, int64_t length, int64_t columns, int64_t rows) const
    {
        if (length < 8) refuse("has a segment with a wrong length", at_);
        const int bits = byte(at_ + 2), components = byte(at_ + 7);
        // Baseline frames may have 12 bits as well: the standard limits them to 8, but some writers store 12.
        const bool is_known = marker == PROGRESSIVE
                                  ? bits == 8 || bits == 12
                                  : (marker <= LOSSLESS || marker == LS_FRAME) && bits >= 2 && bits <= 16;
        if (!is_known) refuse("is of an unknown kind or depth", at_);
        check_size(file_, {number(at_ + 5), number(at_ + 3), components}, columns, rows);
    }

    const InputFile& file_;
    int64_t at_, end_;
};

}  // namespace

bool is_jpeg(const std::string& transfer_syntax)
{
    // .50 to .66: processes 1 to 29; .70: process 14 with predictor 1; .80, .81: JPEG-LS; .90 and up: JPEG 2000 etc.
    return transfer_syntax.size() == PREFIX.size() + 2 && transfer_syntax.starts_with(PREFIX) &&
           transfer_syntax[PREFIX.size()] >= '5' && transfer_syntax[PREFIX.size()] <= '8';
}

void check_jpeg_headers(const InputFile& file, std::span<const DicomLayout::Fragment> fragments, int64_t columns,
                        int64_t rows)
{
    bool is_first = true;
    for (const DicomLayout::Fragment& fragment : fragments) {
        Header header(file, fragment);
        if (header.begins())
            header.check(columns, rows);
        else if (is_first)
            fail(file.path.string(), ": Pixel Data at byte ", fragment.at,
                 " begins no JPEG picture; expected one, as the transfer syntax says");
        is_first = false;
    }
}

}  // namespace shvr
