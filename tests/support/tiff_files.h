#pragma once
// TIFFs for tests, written by libtiff: a page is given as the samples of its pixels, one after the other, in the byte
// order of this machine, rows without gaps (rows of odd bits: packed, highest bit first, each row starting a new byte).

#include <tiffio.h>

#include <functional>

#include "tests/support/volume_files.h"

namespace shvr::test {

struct TiffSpec {
    int width = 5, height = 4;
    int bits = 16;
    int format = SAMPLEFORMAT_UINT;
    int samples = 1;
    int photometric = PHOTOMETRIC_MINISBLACK;
    int compression = COMPRESSION_NONE;
    int predictor = 1;
    bool is_planar = false;
    int tile = 0;            ///< side; 0: strips
    int rows_per_strip = 0;  ///< 0: all
    int orientation = ORIENTATION_TOPLEFT;
    std::vector<uint16_t> extra_samples{};
    std::string description{};
    double x_resolution = 0.0, y_resolution = 0.0;
    int resolution_unit = RESUNIT_NONE;
    int subfile_type = 0;
    std::vector<uint16_t> palette{};  ///< red, green, blue, one after the other
    std::function<void(TIFF*)> more{};

    size_t row_bytes() const { return size_t(width * samples * bits + 7) / 8; }
    size_t page_bytes() const { return row_bytes() * size_t(height); }
};

class TiffWriter {
public:
    /// Mode as libtiff's: "w", with "l" or "b" for the byte order and "8" for BigTIFF.
    TiffWriter(const std::filesystem::path& path, const std::string& mode) : tiff_(TIFFOpen(path.c_str(), mode.c_str()))
    {
        if (tiff_ == nullptr) fail(path.string(), ": libtiff cannot write it");
    }
    TiffWriter(const TiffWriter&) = delete;
    ~TiffWriter() { TIFFClose(tiff_); }

    void page(const TiffSpec& spec, std::string_view samples)
    {
        set_fields(spec);
        if (samples.size() != spec.page_bytes()) fail("a page has ", samples.size(), " bytes");
        bool is_written = true;
        for (int plane = 0; plane < (spec.is_planar ? spec.samples : 1); ++plane) {
            const std::string part = spec.is_planar ? one_sample(spec, samples, plane) : std::string(samples);
            is_written = is_written && (spec.tile > 0 ? tiles(spec, part, plane) : rows(spec, part, plane));
        }
        if (!is_written || TIFFWriteDirectory(tiff_) != 1) fail("libtiff cannot write a page");
    }

    /// A page with one strip that is already compressed.
    void raw_page(const TiffSpec& spec, std::string strip)
    {
        set_fields(spec);
        const bool is_written = TIFFWriteRawStrip(tiff_, 0, strip.data(), static_cast<tmsize_t>(strip.size())) > 0;
        if (!is_written || TIFFWriteDirectory(tiff_) != 1) fail("libtiff cannot write a page");
    }

private:
    void set_fields(const TiffSpec& spec)
    {
        TIFFSetField(tiff_, TIFFTAG_IMAGEWIDTH, spec.width);
        TIFFSetField(tiff_, TIFFTAG_IMAGELENGTH, spec.height);
        TIFFSetField(tiff_, TIFFTAG_BITSPERSAMPLE, spec.bits);
        TIFFSetField(tiff_, TIFFTAG_SAMPLEFORMAT, spec.format);
        TIFFSetField(tiff_, TIFFTAG_SAMPLESPERPIXEL, spec.samples);
        TIFFSetField(tiff_, TIFFTAG_PHOTOMETRIC, spec.photometric);
        TIFFSetField(tiff_, TIFFTAG_COMPRESSION, spec.compression);
        // The default preset allocates 94 MB of tables for each strip.
        if (spec.compression == COMPRESSION_LZMA) TIFFSetField(tiff_, TIFFTAG_LZMAPRESET, 0);
        TIFFSetField(tiff_, TIFFTAG_PLANARCONFIG, spec.is_planar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
        TIFFSetField(tiff_, TIFFTAG_ORIENTATION, spec.orientation);
        if (spec.predictor != 1) TIFFSetField(tiff_, TIFFTAG_PREDICTOR, spec.predictor);
        if (spec.tile > 0) {
            TIFFSetField(tiff_, TIFFTAG_TILEWIDTH, spec.tile);
            TIFFSetField(tiff_, TIFFTAG_TILELENGTH, spec.tile);
        } else {
            TIFFSetField(tiff_, TIFFTAG_ROWSPERSTRIP, spec.rows_per_strip > 0 ? spec.rows_per_strip : spec.height);
        }
        if (!spec.extra_samples.empty()) {
            TIFFSetField(tiff_, TIFFTAG_EXTRASAMPLES, int(spec.extra_samples.size()), spec.extra_samples.data());
        }
        if (!spec.description.empty()) TIFFSetField(tiff_, TIFFTAG_IMAGEDESCRIPTION, spec.description.c_str());
        if (spec.x_resolution > 0.0) {
            TIFFSetField(tiff_, TIFFTAG_XRESOLUTION, spec.x_resolution);
            TIFFSetField(tiff_, TIFFTAG_YRESOLUTION, spec.y_resolution > 0.0 ? spec.y_resolution : spec.x_resolution);
            TIFFSetField(tiff_, TIFFTAG_RESOLUTIONUNIT, spec.resolution_unit);
        }
        if (spec.subfile_type != 0) TIFFSetField(tiff_, TIFFTAG_SUBFILETYPE, spec.subfile_type);
        if (!spec.palette.empty()) {
            const size_t entries = spec.palette.size() / 3;
            TIFFSetField(tiff_, TIFFTAG_COLORMAP, spec.palette.data(), spec.palette.data() + entries,
                         spec.palette.data() + 2 * entries);
        }
        if (spec.more) spec.more(tiff_);
    }

    static std::string one_sample(const TiffSpec& spec, std::string_view samples, int plane)
    {
        std::string part;
        const auto bytes = size_t(spec.bits / 8);
        const size_t step = bytes * size_t(spec.samples);
        for (size_t at = bytes * size_t(plane); at < samples.size(); at += step) {
            part += samples.substr(at, bytes);
        }
        return part;
    }

    // libtiff modifies its input, so rows and tiles are copies.
    bool rows(const TiffSpec& spec, const std::string& samples, int plane)
    {
        const size_t row_bytes = samples.size() / size_t(spec.height);
        for (int y = 0; y < spec.height; ++y) {
            std::string row = samples.substr(size_t(y) * row_bytes, row_bytes);
            if (TIFFWriteScanline(tiff_, row.data(), uint32_t(y), uint16_t(plane)) != 1) return false;
        }
        return true;
    }

    bool tiles(const TiffSpec& spec, const std::string& samples, int plane)
    {
        const auto pixel = size_t(spec.bits / 8 * (spec.is_planar ? 1 : spec.samples));
        const auto side = size_t(spec.tile);
        const auto width = size_t(spec.width);
        for (size_t top = 0; top < size_t(spec.height); top += side) {
            for (size_t left = 0; left < width; left += side) {
                std::string tile(side * side * pixel, '\x55');  // values outside the page must not matter
                for (size_t y = top; y < std::min(top + side, size_t(spec.height)); ++y) {
                    const size_t columns = std::min(side, width - left);
                    samples.copy(tile.data() + (y - top) * side * pixel, columns * pixel, (y * width + left) * pixel);
                }
                if (TIFFWriteTile(tiff_, tile.data(), uint32_t(left), uint32_t(top), 0, uint16_t(plane)) < 0)
                    return false;
            }
        }
        return true;
    }

    TIFF* tiff_;
};

inline std::filesystem::path write_tiff(const std::filesystem::path& path, const TiffSpec& spec,
                                        const std::vector<std::string>& pages, const std::string& mode = "wl")
{
    std::filesystem::remove(path);
    TiffWriter writer(path, mode);
    for (const std::string& page : pages) writer.page(spec, page);
    return path;
}

/// The bytes of the given numbers.
template <class T>
std::string bytes_of_numbers(const std::vector<T>& numbers)
{
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

/// Slice z of the chirality phantom: 5 x 4 voxels of int16, x + 10 y + 100 z - 99.
inline std::string chirality_page(int z)
{
    std::vector<int16_t> voxels;
    for (int i = 0; i < 20; ++i) voxels.push_back(int16_t(i % 5 + 10 * (i / 5) + 100 * z - 99));
    return bytes_of_numbers(voxels);
}

inline std::vector<std::string> chirality_pages()
{
    return {chirality_page(0), chirality_page(1), chirality_page(2)};
}

}  // namespace shvr::test
