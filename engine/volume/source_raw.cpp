#include "engine/volume/source_raw.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/volume/header_text.h"
#include "engine/volume/open_volume.h"

namespace shvr {
namespace {

static_assert(std::endian::native == std::endian::little, "files in little-endian order are taken as they are");

template <class Bits, Bits (*SWAPPED)(Bits)>
void swap_each(std::span<std::byte> bytes)
{
    for (size_t at = 0; at < bytes.size(); at += sizeof(Bits)) {
        Bits bits;
        std::memcpy(&bits, bytes.data() + at, sizeof(Bits));
        bits = SWAPPED(bits);
        std::memcpy(bytes.data() + at, &bits, sizeof(Bits));
    }
}

uint16_t swapped16(uint16_t bits)
{
    return __builtin_bswap16(bits);
}
uint32_t swapped32(uint32_t bits)
{
    return __builtin_bswap32(bits);
}
uint64_t swapped64(uint64_t bits)
{
    return __builtin_bswap64(bits);
}

class RawSource final : public VolumeSource {
public:
    RawSource(VolumeInfo info, RawVoxels voxels, FileDescriptor file)
        : VolumeSource(std::move(info)), voxels_(std::move(voxels)), file_(std::move(file))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 size = info().size;
        const Size3 extent = box.size();
        const auto voxel_bytes = static_cast<int64_t>(bytes_of(info().type));
        SHVR_CHECK(glm::all(glm::greaterThanEqual(box.lower, Size3(0))) &&
                   glm::all(glm::lessThanEqual(box.upper, size)) && glm::all(glm::greaterThan(extent, Size3(0))));
        SHVR_CHECK(static_cast<int64_t>(voxels.size()) == extent.x * extent.y * extent.z * voxel_bytes, voxels.size());

        // Rows that follow each other in the file as in the box are read at once.
        int64_t rows = 1;
        int64_t slices = 1;
        if (extent.x == size.x) rows = extent.y;
        if (extent.x == size.x && extent.y == size.y) slices = extent.z;
        const auto run_bytes = static_cast<size_t>(extent.x * rows * slices * voxel_bytes);
        std::byte* run = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; z += slices) {
            for (int64_t y = box.lower.y; y < box.upper.y; y += rows) {
                const int64_t first = box.lower.x + size.x * (y + size.y * z);
                read_run(voxels_.offset_bytes + first * voxel_bytes, {run, run_bytes});
                run += run_bytes;
            }
        }
        if (voxels_.big_endian && voxel_bytes == 2) swap_each<uint16_t, swapped16>(voxels);
        if (voxels_.big_endian && voxel_bytes == 4) swap_each<uint32_t, swapped32>(voxels);
        if (voxels_.big_endian && voxel_bytes == 8) swap_each<uint64_t, swapped64>(voxels);
    }

private:
    void read_run(int64_t offset, std::span<std::byte> bytes) const
    {
        while (!bytes.empty()) {
            const ssize_t count = ::pread(file_.number(), bytes.data(), bytes.size(), offset);
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail(voxels_.file.string(), ": cannot be read: ", reason_of(errno));
            if (count == 0) {
                fail(voxels_.file.string(), ": ended after ", offset, " bytes; expected ",
                     offset + static_cast<int64_t>(bytes.size()), ": it was cut short while open");
            }
            bytes = bytes.subspan(static_cast<size_t>(count));
            offset += count;
        }
    }

    RawVoxels voxels_;
    FileDescriptor file_;
};

}  // namespace

std::unique_ptr<VolumeSource> open_raw_voxels(VolumeInfo info, const RawVoxels& voxels)
{
    const std::string name = voxels.file.string();
    // Without O_NONBLOCK, opening a FIFO waits for a writer before we can see that it is one.
    FileDescriptor file(::open(voxels.file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) fail(name, ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(name, ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) {
        fail(name, ": is ", S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device", "; expected a file");
    }

    const bool at_end = voxels.offset_bytes == RawVoxels::AT_END;
    const int64_t offset = at_end ? 0 : voxels.offset_bytes;
    SHVR_CHECK(offset >= 0, offset);
    int64_t needed = 0;
    if (__builtin_mul_overflow(voxel_count(info), static_cast<int64_t>(bytes_of(info.type)), &needed) ||
        __builtin_add_overflow(needed, offset, &needed)) {
        fail(name, ": offset is ", offset, "; expected one that leaves room for the voxels within 2^63 bytes");
    }
    const int64_t held = status.st_size;
    if (held < needed) {
        fail(name, ": holds ", held, " bytes; expected at least ", needed, " for ", info.size.x, "x", info.size.y, "x",
             info.size.z, " voxels of ", name_of(info.type),
             offset > 0 ? sentence(" after a header of ", offset) : std::string());
    }
    if (held > needed && !at_end) {
        info.warnings.push_back(sentence(voxels.file.filename().string(), " holds ", held - needed,
                                         " bytes more than the voxels need; they were left out"));
    }
    RawVoxels placed = voxels;
    placed.offset_bytes = at_end ? held - needed : offset;
    return std::make_unique<RawSource>(std::move(info), std::move(placed), std::move(file));
}

std::unique_ptr<VolumeSource> open_raw(const std::filesystem::path& path, const RawLayout& layout)
{
    VolumeInfo info{.name = path.filename().string(), .format = "raw", .size = layout.size, .type = layout.type};
    const bool stated = layout.spacing != glm::dvec3(1.0) || layout.unit != "voxel";
    apply_spacing(info, stated ? std::optional(layout.spacing) : std::nullopt, layout.unit, "voxel");
    return open_raw_voxels(std::move(info), {path, layout.offset_bytes, layout.big_endian});
}

}  // namespace shvr
