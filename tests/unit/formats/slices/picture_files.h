#pragma once
// Pictures as the tests of slices need them: PNG chunk by chunk, so that they may be wrong; BMP; JPEG.

#include <cstdio>

#include <jpeglib.h>
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace shvr::test {

inline std::string big_endian(uint32_t number)
{
    return {char(number >> 24), char(number >> 16), char(number >> 8), char(number)};
}

inline std::string png_chunk(const std::string& type, const std::string& data)
{
    const std::string checked = type + data;
    const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(checked.data()), uInt(checked.size()));
    return big_endian(uint32_t(data.size())) + checked + big_endian(uint32_t(crc));
}

struct PngParts {
    uint32_t width = 0, height = 0;
    int bits = 8;
    int color_type = 0;  ///< 0 grey, 2 colours, 3 palette, 4 grey with alpha
    std::string palette{};
    bool is_interlaced = false;
};

/// `rows`: the bytes of each row, as PNG stores them (16 bits big-endian).
inline std::string png_of(const PngParts& parts, const std::vector<std::string>& rows)
{
    std::string filtered;
    for (const std::string& row : rows) filtered += '\0' + row;
    std::string packed(::compressBound(uLong(filtered.size())), '\0');
    uLongf bytes = uLongf(packed.size());
    ::compress(reinterpret_cast<Bytef*>(packed.data()), &bytes, reinterpret_cast<const Bytef*>(filtered.data()),
               uLong(filtered.size()));
    packed.resize(bytes);
    const std::string header = big_endian(parts.width) + big_endian(parts.height) + char(parts.bits) +
                               char(parts.color_type) + std::string(2, '\0') + char(parts.is_interlaced);
    return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) +
           (parts.palette.empty() ? "" : png_chunk("PLTE", parts.palette)) + png_chunk("IDAT", packed) +
           png_chunk("IEND", "");
}

/// Bottom-up, of 8 bits with the palette (4 bytes a colour) or 24 bits without one. `rows`: from the top.
inline std::string bmp_of(uint32_t width, int bits, const std::string& palette, const std::vector<std::string>& rows)
{
    const auto little = [](uint32_t number, int bytes) {
        std::string text;
        for (int i = 0; i < bytes; ++i) text += char(number >> (8 * i));
        return text;
    };
    std::string pixels;
    for (auto row = rows.rbegin(); row != rows.rend(); ++row)
        pixels += *row + std::string((4 - row->size() % 4) % 4, '\0');
    const auto offset = uint32_t(54 + palette.size());
    return "BM" + little(offset + uint32_t(pixels.size()), 4) + little(0, 4) + little(offset, 4) + little(40, 4) +
           little(width, 4) + little(uint32_t(rows.size()), 4) + little(1, 2) + little(uint32_t(bits), 2) +
           little(0, 4) + little(uint32_t(pixels.size()), 4) + little(0, 4) + little(0, 4) +
           little(uint32_t(palette.size() / 4), 4) + little(0, 4) + palette + pixels;
}

/// Of quality 100; `components`: 1 grey, 3 colours.
inline std::string jpeg_of(uint32_t width, int components, const std::vector<std::string>& rows,
                           bool is_progressive = false)
{
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* bytes = nullptr;
    unsigned long count = 0;
    jpeg_mem_dest(&jpeg, &bytes, &count);
    jpeg.image_width = width;
    jpeg.image_height = JDIMENSION(rows.size());
    jpeg.input_components = components;
    jpeg.in_color_space = components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 100, TRUE);
    if (is_progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (std::string row : rows) {
        JSAMPROW line = reinterpret_cast<JSAMPROW>(row.data());
        jpeg_write_scanlines(&jpeg, &line, 1);
    }
    jpeg_finish_compress(&jpeg);
    std::string text(reinterpret_cast<char*>(bytes), count);
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
    return text;
}

}  // namespace shvr::test
