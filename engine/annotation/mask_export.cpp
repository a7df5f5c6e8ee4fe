#include "engine/annotation/mask_export.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "engine/annotation/mask_file.h"
#include "engine/annotation/trace_forms.h"
#include "engine/base/atomic_file.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/volume/header_text.h"

namespace shvr {

namespace {

constexpr int64_t SIDE = gpu::BRICK_SIZE;
constexpr int64_t STRIP_BYTES = int64_t{1} << 18;

/// Rows [first, last) of a slice.
std::vector<uint8_t> rows_of(const Mask& mask, int64_t z, int64_t first, int64_t last)
{
    const Size3 size = mask.size();
    const glm::i64vec3 counts = mask.brick_counts();
    std::vector<uint8_t> rows(size_t(size.x * (last - first)), 0);
    for (int64_t y = first; y < last; ++y)
        for (int64_t brick_x = 0; brick_x < counts.x; ++brick_x) {
            const MaskBrick* brick = mask.brick(brick_x + counts.x * (y / SIDE + counts.y * (z / SIDE)));
            if (!brick) continue;
            const int64_t x = brick_x * SIDE;
            std::copy_n(brick->begin() + SIDE * (y % SIDE + SIDE * (z % SIDE)), std::min(SIDE, size.x - x),
                        rows.begin() + x + size.x * (y - first));
        }
    return rows;
}

int64_t rows_at_once(const Mask& mask)
{
    return std::clamp<int64_t>(STRIP_BYTES / mask.size().x, 1, mask.size().y);
}

void export_nrrd(const std::filesystem::path& path, const Mask& mask, const TraceSpace& space)
{
    AtomicWriter writer(path);
    // Quotes would end the name of the unit.
    std::string unit = space.unit;
    std::replace(unit.begin(), unit.end(), '"', '\'');
    const std::string quoted = "\"" + unit + "\"";
    const std::string header = sentence("NRRD0004\ntype: uint8\ndimension: 3\nsizes: ", digits_of(mask.size()),
                                        "\nspacings: ", digits_of(space.spacing), "\nunits: ", quoted, " ", quoted, " ",
                                        quoted, "\nencoding: raw\n\n");
    writer.append(std::as_bytes(std::span(header)));
    const int64_t step = rows_at_once(mask);
    for (int64_t z = 0; z < mask.size().z; ++z)
        for (int64_t y = 0; y < mask.size().y; y += step) {
            const std::vector<uint8_t> rows = rows_of(mask, z, y, std::min(y + step, mask.size().y));
            writer.append(std::as_bytes(std::span(rows)));
        }
    writer.commit();
}

/// A file in memory, as libtiff's client functions see it.
struct MemoryFile {
    std::vector<std::byte> bytes{};
    size_t at = 0;
    std::string complaint{};

    static MemoryFile& of(thandle_t handle) { return *static_cast<MemoryFile*>(handle); }
    static tmsize_t read(thandle_t handle, void* data, tmsize_t count)
    {
        MemoryFile& file = of(handle);
        const size_t some = std::min(size_t(count), file.bytes.size() - std::min(file.at, file.bytes.size()));
        std::memcpy(data, file.bytes.data() + file.at, some);
        file.at += some;
        return tmsize_t(some);
    }
    static tmsize_t write(thandle_t handle, void* data, tmsize_t count)
    {
        MemoryFile& file = of(handle);
        file.bytes.resize(std::max(file.bytes.size(), file.at + size_t(count)));
        std::memcpy(file.bytes.data() + file.at, data, size_t(count));
        file.at += size_t(count);
        return count;
    }
    static toff_t seek(thandle_t handle, toff_t offset, int whence)
    {
        MemoryFile& file = of(handle);
        file.at = size_t(offset) + (whence == SEEK_CUR ? file.at : whence == SEEK_END ? file.bytes.size() : 0);
        return file.at;
    }
    static int close(thandle_t) { return 0; }
    static toff_t size(thandle_t handle) { return of(handle).bytes.size(); }
    static int complain(TIFF*, void* user, const char*, const char* format, va_list arguments)
    {
        char text[256];
        std::vsnprintf(text, sizeof text, format, arguments);
        MemoryFile& file = *static_cast<MemoryFile*>(user);
        if (file.complaint.empty()) file.complaint = printable(text);
        return 1;
    }
};

class TiffWriter {
public:
    TiffWriter(std::filesystem::path path, const Mask& mask) : path_(std::move(path))
    {
        const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                                   TIFFOpenOptionsFree);
        TIFFOpenOptionsSetErrorHandlerExtR(options.get(), MemoryFile::complain, &file_);
        // Whether offsets of 32 bits suffice must be known before anything is compressed.
        const bool is_big = mask.size().x * mask.size().y > (int64_t{1} << 31) / mask.size().z;
        tiff_ =
            TIFFClientOpenExt("mask", is_big ? "w8" : "w", &file_, MemoryFile::read, MemoryFile::write,
                              MemoryFile::seek, MemoryFile::close, MemoryFile::size, nullptr, nullptr, options.get());
        check(tiff_ != nullptr);
    }
    ~TiffWriter()
    {
        if (tiff_) TIFFClose(tiff_);
    }
    TiffWriter(const TiffWriter&) = delete;
    TiffWriter& operator=(const TiffWriter&) = delete;

    template <class... Values>
    void set(uint32_t tag, Values... values)
    {
        check(TIFFSetField(tiff_, tag, values...) == 1);
    }
    void write_strip(uint32_t strip, std::vector<uint8_t> rows)
    {
        check(TIFFWriteEncodedStrip(tiff_, strip, rows.data(), tmsize_t(rows.size())) == tmsize_t(rows.size()));
    }
    void end_page() { check(TIFFWriteDirectory(tiff_) == 1); }
    const std::vector<std::byte>& close()
    {
        TIFFClose(std::exchange(tiff_, nullptr));
        check(file_.complaint.empty());
        return file_.bytes;
    }

private:
    void check(bool holds) const
    {
        if (!holds) fail(path_.string(), ": cannot be made as a TIFF: ", file_.complaint);
    }
    std::filesystem::path path_;
    MemoryFile file_;
    TIFF* tiff_ = nullptr;
};

void export_tiff(const std::filesystem::path& path, const Mask& mask, const TraceSpace& space)
{
    const Size3 size = mask.size();
    TiffWriter writer(path, mask);
    const int64_t step = rows_at_once(mask);
    const std::string description = sentence("ImageJ=1.53t\nimages=", size.z, "\nslices=", size.z,
                                             "\nunit=", space.unit == "um" ? "micron" : space.unit,
                                             "\nspacing=", digits_of(space.spacing.z), "\nloop=false\n");
    for (int64_t z = 0; z < size.z; ++z) {
        writer.set(TIFFTAG_IMAGEWIDTH, uint32_t(size.x));
        writer.set(TIFFTAG_IMAGELENGTH, uint32_t(size.y));
        writer.set(TIFFTAG_BITSPERSAMPLE, 8);
        writer.set(TIFFTAG_SAMPLESPERPIXEL, 1);
        writer.set(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        writer.set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        writer.set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        writer.set(TIFFTAG_ROWSPERSTRIP, uint32_t(step));
        writer.set(TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE);
        writer.set(TIFFTAG_XRESOLUTION, 1.0 / space.spacing.x);
        writer.set(TIFFTAG_YRESOLUTION, 1.0 / space.spacing.y);
        if (z == 0) writer.set(TIFFTAG_IMAGEDESCRIPTION, description.c_str());
        for (int64_t y = 0; y < size.y; y += step)
            writer.write_strip(uint32_t(y / step), rows_of(mask, z, y, std::min(y + step, size.y)));
        writer.end_page();
    }
    write_file_atomically(path, writer.close());
}

std::string form_of(const std::filesystem::path& path)
{
    return lower_case(path.extension().string());
}

}  // namespace

bool is_mask_export(const std::filesystem::path& path)
{
    const std::string form = form_of(path);
    return form == ".mask" || form == ".nrrd" || form == ".tif" || form == ".tiff";
}

void export_mask(const std::filesystem::path& path, const Mask& mask, const TraceSpace& space)
{
    SHVR_CHECK(mask.size() == space.size);
    const std::string form = form_of(path);
    if (form == ".mask") return save_mask(path, mask);
    if (form == ".nrrd") return export_nrrd(path, mask, space);
    if (form == ".tif" || form == ".tiff") return export_tiff(path, mask, space);
    fail(path.string(), ": has the extension ", in_quotes(path.extension().string()),
         "; expected .mask, .nrrd or .tif");
}

}  // namespace shvr
