#include "engine/formats/byte_order.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "engine/base/error.h"
#include "engine/formats/header_fields.h"

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

/// Counts pairs of neighbouring voxels along x by the byte order in which their two values are closer to each other.
struct Votes {
    int64_t little = 0;
    int64_t big = 0;
};

template <class T>
void vote(std::span<const std::byte> row, Votes& votes)
{
    std::vector<std::byte> swapped(row.begin(), row.end());
    swap_bytes(swapped, sizeof(T));
    const auto distance = [](std::span<const std::byte> voxels, size_t i) {
        T pair[2];
        std::memcpy(pair, voxels.data() + i * sizeof(T), sizeof(pair));
        const double difference = std::abs(double(pair[1]) - double(pair[0]));
        return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
    };
    for (size_t i = 0; i + 1 < row.size() / sizeof(T); ++i) {
        const double little = distance(row, i);
        const double big = distance(swapped, i);
        votes.little += little < big;
        votes.big += big < little;
    }
}

void vote(VoxelType type, std::span<const std::byte> row, Votes& votes)
{
    switch (type) {
        case VoxelType::uint8:
        case VoxelType::int8: return;
        case VoxelType::uint16: return vote<uint16_t>(row, votes);
        case VoxelType::int16: return vote<int16_t>(row, votes);
        case VoxelType::uint32: return vote<uint32_t>(row, votes);
        case VoxelType::int32: return vote<int32_t>(row, votes);
        case VoxelType::float32: return vote<float>(row, votes);
        case VoxelType::float64: return vote<double>(row, votes);
    }
}

}  // namespace

void swap_bytes(std::span<std::byte> voxels, size_t voxel_bytes)
{
    if (voxel_bytes == 2) swap_each<uint16_t, swapped16>(voxels);
    if (voxel_bytes == 4) swap_each<uint32_t, swapped32>(voxels);
    if (voxel_bytes == 8) swap_each<uint64_t, swapped64>(voxels);
}

std::string byte_order_warning(const VolumeInfo& info, const VoxelBytes* bytes)
{
    constexpr int64_t ROWS = 64;  // samples rows of the middle slice, since the first slices may be air
    constexpr int64_t MAX_VOXELS = 4096;
    Votes votes;
    const auto voxel_bytes = int64_t(bytes_of(info.type));
    std::vector<std::byte> row(size_t(std::min(info.size.x, MAX_VOXELS) * voxel_bytes));
    for (int64_t i = 0; bytes != nullptr && i < ROWS; ++i) {
        const int64_t y = info.size.y * i / ROWS;
        bytes->read(voxel_bytes * info.size.x * (y + info.size.y * (info.size.z / 2)), row);
        vote(info.type, row, votes);
    }
    if (votes.big <= 2 * votes.little) return NO_BYTE_ORDER;
    return sentence(NO_BYTE_ORDER,
                    ", though neighbouring voxels are more alike as big-endian, which is a guess: "
                    "--raw WxHxD:TYPE:big reads them so");
}

}  // namespace shvr
