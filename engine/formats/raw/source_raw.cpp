#include "engine/formats/raw/source_raw.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/byte_order.h"
#include "engine/formats/inflated_bytes.h"

namespace shvr {
namespace {

/// Bytes of decoded data to cache per deflated part. Each part is one slice, and several may be open at once.
constexpr int64_t KEPT_OF_PART = int64_t{2} << 20;

struct Layout {
    bool big_endian = false;
    int64_t channels = 1;
    int64_t channel = 0;
};

class RawSource final : public VolumeSource {
public:
    RawSource(VolumeInfo info, const Layout& layout, std::unique_ptr<VoxelBytes> bytes)
        : VolumeSource(std::move(info)), layout_(layout), bytes_(std::move(bytes))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 size = info().size;
        const Size3 extent = box.size();
        const auto voxel_bytes = int64_t(bytes_of(info().type));
        SHVR_CHECK(glm::all(glm::greaterThanEqual(box.lower, Size3(0))) &&
                   glm::all(glm::lessThanEqual(box.upper, size)) && glm::all(glm::greaterThan(extent, Size3(0))));
        SHVR_CHECK(int64_t(voxels.size()) == extent.x * extent.y * extent.z * voxel_bytes, voxels.size());

        // Rows that are consecutive in both file and box are read together.
        int64_t rows = 1;
        int64_t slices = 1;
        if (extent.x == size.x) rows = extent.y;
        if (extent.x == size.x && extent.y == size.y) slices = extent.z;
        const auto run_bytes = size_t(extent.x * rows * slices * voxel_bytes);
        std::byte* run = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; z += slices) {
            for (int64_t y = box.lower.y; y < box.upper.y; y += rows) {
                const int64_t first = box.lower.x + size.x * (y + size.y * z);
                read_run(first, {run, run_bytes});
                run += run_bytes;
            }
        }
        if (layout_.big_endian) swap_bytes(voxels, bytes_of(info().type));
    }

private:
    void read_run(int64_t first_voxel, std::span<std::byte> voxels) const
    {
        const size_t voxel_bytes = bytes_of(info().type);
        const int64_t stride = layout_.channels * int64_t(voxel_bytes);
        if (layout_.channels == 1) return bytes_->read(first_voxel * stride, voxels);
        constexpr size_t BLOCK_BYTES = size_t{1} << 20;
        const size_t block_voxels = std::max<size_t>(1, BLOCK_BYTES / size_t(stride));
        std::vector<std::byte> block(size_t(stride) * std::min(block_voxels, voxels.size() / voxel_bytes));
        while (!voxels.empty()) {
            const size_t count = std::min(block_voxels, voxels.size() / voxel_bytes);
            bytes_->read(first_voxel * stride, std::span(block).first(count * size_t(stride)));
            const std::byte* from = block.data() + size_t(layout_.channel) * voxel_bytes;
            for (size_t i = 0; i < count; ++i, from += stride) {
                std::memcpy(voxels.data() + i * voxel_bytes, from, voxel_bytes);
            }
            voxels = voxels.subspan(count * voxel_bytes);
            first_voxel += int64_t(count);
        }
    }

    Layout layout_;
    std::unique_ptr<VoxelBytes> bytes_;
};

// ---- Opening: checks sizes against files ----------------------------------------------------------------------------

/// Returns the number of bytes of all channels of all voxels. Fails if the number exceeds 63 bits.
int64_t bytes_of_voxels(const VolumeInfo& info, const RawVoxels& voxels, int64_t offset)
{
    SHVR_CHECK(offset >= 0 && voxels.channels >= 1 && voxels.channel >= 0 && voxels.channel < voxels.channels);
    int64_t needed = 0;
    int64_t all = 0;
    if (__builtin_mul_overflow(voxel_count(info), int64_t(bytes_of(info.type)), &needed) ||
        __builtin_mul_overflow(needed, voxels.channels, &needed) ||
        __builtin_add_overflow(needed, voxels.bytes_after, &all) || __builtin_add_overflow(all, offset, &all)) {
        fail(voxels.file.string(), ": offset is ", offset,
             "; expected one that leaves room for the voxels within 2^63 bytes");
    }
    return needed;
}

std::string size_text(const VolumeInfo& info, const RawVoxels& voxels)
{
    return sentence(info.size.x, "x", info.size.y, "x", info.size.z, " voxels of ",
                    voxels.channels > 1 ? sentence(voxels.channels, " times ") : std::string(), name_of(info.type));
}

/// Checks that `file` holds `needed` bytes at `offset`, then `after` more. Returns `offset`, with AT_END resolved.
int64_t place_in_file(const InputFile& file, int64_t offset, int64_t needed, int64_t after, const std::string& of_what)
{
    const int64_t all = (offset == RawVoxels::AT_END ? 0 : offset) + needed + after;
    if (file.bytes < all) {
        fail(file.path.string(), ": holds ", file.bytes, " bytes; expected at least ", all, " for ", of_what,
             offset > 0 ? sentence(" after a header of ", offset) : std::string());
    }
    return offset == RawVoxels::AT_END ? file.bytes - needed : offset;
}

std::unique_ptr<VoxelBytes> open_one(VolumeInfo& info, const RawVoxels& voxels)
{
    InputFile file = open_input_file(voxels.file);
    const bool at_end = voxels.offset_bytes == RawVoxels::AT_END;
    const int64_t offset = at_end ? 0 : voxels.offset_bytes;
    const int64_t needed = bytes_of_voxels(info, voxels, voxels.is_deflated ? voxels.skip_bytes : offset);
    if (voxels.is_deflated) {
        return bytes_of_deflated(
            {.file = std::move(file), .offset_bytes = offset, .skip_bytes = voxels.skip_bytes, .wanted_bytes = needed});
    }
    const int64_t begin = place_in_file(file, voxels.offset_bytes, needed, voxels.bytes_after, size_text(info, voxels));
    if (const int64_t more = file.bytes - begin - needed - voxels.bytes_after; more > 0 && !at_end) {
        info.warnings.push_back(sentence(voxels.file.filename().string(), " holds ", more,
                                         " bytes more than the voxels need; they are ignored"));
    }
    return bytes_of_file(std::move(file), begin);
}

std::unique_ptr<VoxelBytes> open_part(const RawVoxels& voxels, const RawVoxels::Part& part, int64_t share,
                                      const std::string& of_what)
{
    InputFile file = open_input_file(part.file);
    if (voxels.is_deflated) {
        return bytes_of_deflated({.file = std::move(file),
                                  .offset_bytes = part.offset_bytes,
                                  .skip_bytes = voxels.skip_bytes,
                                  .wanted_bytes = share,
                                  .kept_bytes = KEPT_OF_PART});
    }
    const int64_t begin = place_in_file(file, part.offset_bytes, share, 0, of_what);
    return bytes_of_file(std::move(file), begin);
}

std::unique_ptr<VoxelBytes> open_parts(const VolumeInfo& info, const RawVoxels& voxels)
{
    const int64_t needed = bytes_of_voxels(info, voxels, 0);
    const auto count = int64_t(voxels.parts.size());
    SHVR_CHECK(needed % count == 0, needed, " ", count);
    const int64_t share = needed / count;
    const std::string of_what =
        sentence(count == 1 ? "" : sentence("one of ", count, " equal parts of "), size_text(info, voxels));
    // Checks every file on opening, so that a missing slice is not found only after an hour of work.
    for (const RawVoxels::Part& part : voxels.parts) static_cast<void>(open_part(voxels, part, share, of_what));
    return bytes_of_parts(voxels.parts.size(), share, [voxels, share, of_what](size_t i) {
        return open_part(voxels, voxels.parts[i], share, of_what);
    });
}

}  // namespace

std::unique_ptr<VolumeSource> open_raw_voxels(VolumeInfo info, const RawVoxels& voxels)
{
    std::unique_ptr<VoxelBytes> bytes = voxels.parts.empty() ? open_one(info, voxels) : open_parts(info, voxels);
    if (!voxels.big_endian && bytes_of(info.type) > 1) {
        const bool may_look = voxels.channels == 1 && !voxels.is_deflated;
        info.warnings.push_back(byte_order_warning(info, may_look ? bytes.get() : nullptr));
    }
    const Layout layout{voxels.big_endian.value_or(false), voxels.channels, voxels.channel};
    return std::make_unique<RawSource>(std::move(info), layout, std::move(bytes));
}

}  // namespace shvr
