#include "engine/annotation/files/offset_file.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "engine/annotation/files/voxel_strips.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

static_assert(std::endian::native == std::endian::little, "files hold what memory holds");

int64_t file_bytes_of(VoxelType type)
{
    return bytes_of(type) == 1 ? 2 : 4;
}

uint32_t load_bits(const std::byte* from, int64_t bytes)
{
    if (bytes == 2) {
        int16_t offset = 0;
        std::memcpy(&offset, from, sizeof offset);
        return std::bit_cast<uint32_t>(int32_t{offset});
    }
    uint32_t bits = 0;
    std::memcpy(&bits, from, sizeof bits);
    return bits;
}

void store_bits(uint32_t bits, std::byte* to, int64_t bytes)
{
    std::memcpy(to, &bits, size_t(bytes));  // two's complement: the low half of `bits` is the 16-bit number
}

/// -0 becomes 0.
uint32_t checked(const std::filesystem::path& path, VoxelType type, uint32_t bits, const Size3& voxel)
{
    const double offset = offset_of(type, bits), limit = offset_limit(type);
    const auto refuse = [&](auto found, auto most) {
        fail(path.string(), ": the offset of voxel ", voxel.x, ", ", voxel.y, ", ", voxel.z, " is ", found,
             "; expected -", most, " to ", most, " for a volume of ", name_of(type));
    };
    if (!(std::abs(offset) <= limit)) {
        if (is_float(type)) refuse(offset, limit);
        refuse(int64_t(offset), int64_t(limit));
    }
    return offset == 0.0 ? 0 : bits;
}

}  // namespace

void save_offsets(const std::filesystem::path& path, const DensityField& field, const Progress& progress)
{
    const glm::i64vec3 counts = field.brick_counts();
    const int64_t bytes = file_bytes_of(field.type());
    expect_space(path, bytes_of_voxels(field.size(), bytes), MORE_SPACE);
    AtomicWriter writer(path);
    std::vector<std::byte> content;
    for_each_strip(field.size(), [&](const VoxelStrip& strip) {
        content.assign(strip.voxels() * size_t(bytes), std::byte{0});
        const int64_t first_brick = counts.x * (strip.brick_y + counts.y * (strip.z / gpu::BRICK_SIZE));
        for (int64_t x = 0; x < counts.x; ++x) {
            const std::shared_ptr<const OffsetBrick> brick = field.brick(first_brick + x);
            if (!brick) continue;
            for_each_row(strip, x, [&](size_t in_strip, size_t in_brick, size_t width) {
                for (size_t i = 0; i < width; ++i)
                    store_bits((*brick)[in_brick + i], content.data() + (in_strip + i) * size_t(bytes), bytes);
            });
        }
        writer.append(content);
        if (strip.ends_slice()) tell(progress, double(strip.z + 1) / double(field.size().z));
    });
    writer.commit();
}

DensityField load_offsets(const std::filesystem::path& path, const Size3& size, VoxelType type)
{
    const int64_t bytes = file_bytes_of(type);
    const FileDescriptor file = open_voxels(path, size, bytes, ".offset");
    DensityField field(size, type);
    const glm::i64vec3 counts = field.brick_counts();
    std::map<int64_t, OffsetBrick> layer;  // bricks read so far
    std::vector<std::byte> content;
    for_each_strip(size, [&](const VoxelStrip& strip) {
        content.resize(strip.voxels() * size_t(bytes));
        read_next(file, path, content);
        const int64_t first_brick = counts.x * (strip.brick_y + counts.y * (strip.z / gpu::BRICK_SIZE));
        for (int64_t x = 0; x < counts.x; ++x)
            for_each_row(strip, x, [&](size_t in_strip, size_t in_brick, size_t width) {
                for (size_t i = 0; i < width; ++i) {
                    const uint32_t bits = load_bits(content.data() + (in_strip + i) * size_t(bytes), bytes);
                    if (bits == 0) continue;
                    const auto at = int64_t(in_strip + i);
                    layer[first_brick + x][in_brick + i] = checked(
                        path, type, bits, {at % size.x, strip.brick_y * gpu::BRICK_SIZE + at / size.x, strip.z});
                }
            });
        if (!strip.ends_layer()) return;
        for (auto& [index, offsets] : layer) field.put(index, offsets);
        layer.clear();
    });
    return field;
}

}  // namespace shvr
