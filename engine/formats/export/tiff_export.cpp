// Writes a volume as a TIFF through libtiff, which seeks back in the file to link each page to the next.

#include <tiffio.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/export/volume_export.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

/// The output file for libtiff's client functions. C code calls these functions, so they must not
/// throw.
struct ClientFile {
    AtomicWriter& writer;
    int64_t at = 0, size = 0;
    std::string complaint{};

    static ClientFile& of(thandle_t handle) { return *static_cast<ClientFile*>(handle); }
    template <class Work>
    tmsize_t moved(tmsize_t count, const Work& work)
    {
        try {
            work();
        } catch (const std::exception& error) {
            if (complaint.empty()) complaint = error.what();
            return -1;
        }
        at += count;
        size = std::max(size, at);
        return count;
    }
    static tmsize_t read(thandle_t handle, void* data, tmsize_t count)
    {
        ClientFile& file = of(handle);
        const int64_t some = std::clamp<int64_t>(file.size - file.at, 0, count);
        return file.moved(some, [&] { file.writer.read_back(file.at, {static_cast<std::byte*>(data), size_t(some)}); });
    }
    static tmsize_t write(thandle_t handle, void* data, tmsize_t count)
    {
        ClientFile& file = of(handle);
        return file.moved(count, [&] {
            file.writer.write_at(file.at, {static_cast<const std::byte*>(data), size_t(count)});
        });
    }
    static toff_t seek(thandle_t handle, toff_t offset, int whence)
    {
        ClientFile& file = of(handle);
        file.at = int64_t(offset) + (whence == SEEK_CUR ? file.at : whence == SEEK_END ? file.size : 0);
        return static_cast<toff_t>(file.at);
    }
    static int close(thandle_t) { return 0; }
    static toff_t size_of(thandle_t handle) { return static_cast<toff_t>(of(handle).size); }
    static int complain(TIFF*, void* user, const char*, const char* format, va_list arguments)
    {
        char text[256];
        std::vsnprintf(text, sizeof text, format, arguments);
        ClientFile& file = *static_cast<ClientFile*>(user);
        if (file.complaint.empty()) file.complaint = printable(text);
        return 1;
    }
};

class TiffWriter {
public:
    TiffWriter(std::filesystem::path path, AtomicWriter& writer, bool is_big) : path_(std::move(path)), file_{writer}
    {
        const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                                   TIFFOpenOptionsFree);
        TIFFOpenOptionsSetErrorHandlerExtR(options.get(), ClientFile::complain, &file_);
        tiff_ = TIFFClientOpenExt("volume", is_big ? "w8" : "w", &file_, ClientFile::read, ClientFile::write,
                                  ClientFile::seek, ClientFile::close, ClientFile::size_of, nullptr, nullptr,
                                  options.get());
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
    void write_strip(uint32_t strip, std::vector<std::byte>& rows)
    {
        const auto bytes = static_cast<tmsize_t>(rows.size());
        check(TIFFWriteEncodedStrip(tiff_, strip, rows.data(), bytes) == bytes);
    }
    void end_page() { check(TIFFWriteDirectory(tiff_) == 1); }
    void close()
    {
        TIFFClose(std::exchange(tiff_, nullptr));
        check(file_.complaint.empty());
    }

private:
    void check(bool holds) const
    {
        if (!holds) fail(path_.string(), ": cannot be made as a TIFF: ", file_.complaint);
    }
    std::filesystem::path path_;
    ClientFile file_;
    TIFF* tiff_ = nullptr;
};

int sample_format(VoxelType type)
{
    if (is_float(type)) return SAMPLEFORMAT_IEEEFP;
    const bool is_signed = type == VoxelType::int8 || type == VoxelType::int16 || type == VoxelType::int32;
    return is_signed ? SAMPLEFORMAT_INT : SAMPLEFORMAT_UINT;
}

/// Returns the description lines for ImageJ, which ignores unknown keys. The lines hold no spacing in x and y for
/// ImageJ, because it reads these from the pages' resolution fields, fractions of 32-bit integers.
std::string description_of(const VolumeInfo& info)
{
    const std::string unit = plain_unit(info.unit);
    std::string lines = sentence("ImageJ=1.53t\nimages=", info.size.z, "\nslices=", info.size.z,
                                 "\nunit=", unit == "um" ? "micron" : unit, "\nspacing=", digits_of(info.spacing.z),
                                 "\nloop=false\n", "shvr_spacing=", digits_of(info.spacing), "\n");
    if (info.format == "mask" || info.format == "offsets") lines += "shvr_content=" + info.format + "\n";
    if (!states_place(info)) return lines;
    lines += "shvr_frame=" + info.frame + "\nshvr_directions=";
    for (int axis = 0; axis < 3; ++axis) lines += (axis == 0 ? "" : " ") + digits_of(info.directions[axis]);
    return lines + "\nshvr_origin=" + digits_of(info.origin) + "\n";
}

}  // namespace

void export_tiff(const std::filesystem::path& path, const VolumeSource& source)
{
    const VolumeInfo& info = source.info();
    const Size3& size = info.size;
    const auto voxel_bytes = int64_t(bytes_of(info.type));
    AtomicWriter file(path);
    // The choice between TIFF and BigTIFF must be made before the compressed size is known, so the raw size decides.
    TiffWriter writer(path, file, size.x * size.y * voxel_bytes > (int64_t{1} << 31) / size.z);
    const int64_t step = export_rows(info);
    const std::string description = description_of(info);
    std::vector<std::byte> voxels;
    for (int64_t z = 0; z < size.z; ++z) {
        writer.set(TIFFTAG_IMAGEWIDTH, uint32_t(size.x));
        writer.set(TIFFTAG_IMAGELENGTH, uint32_t(size.y));
        writer.set(TIFFTAG_BITSPERSAMPLE, int(8 * voxel_bytes));
        writer.set(TIFFTAG_SAMPLESPERPIXEL, 1);
        writer.set(TIFFTAG_SAMPLEFORMAT, sample_format(info.type));
        writer.set(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        writer.set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        writer.set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        writer.set(TIFFTAG_ROWSPERSTRIP, uint32_t(step));
        writer.set(TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE);
        writer.set(TIFFTAG_XRESOLUTION, 1.0 / info.spacing.x);
        writer.set(TIFFTAG_YRESOLUTION, 1.0 / info.spacing.y);
        if (z == 0) writer.set(TIFFTAG_IMAGEDESCRIPTION, description.c_str());
        for (int64_t y = 0; y < size.y; y += step) {
            const VoxelBox box{{0, y, z}, {size.x, std::min(y + step, size.y), z + 1}};
            voxels.resize(size_t(box.size().x * box.size().y * voxel_bytes));
            source.read(box, voxels);
            writer.write_strip(uint32_t(y / step), voxels);
        }
        writer.end_page();
    }
    writer.close();
    file.commit();
}

}  // namespace shvr
