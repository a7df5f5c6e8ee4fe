#include "engine/formats/zarr/zarr_volume.h"

#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/formats/zarr/zarr_codec.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {
namespace {

template <class Bits>
Bits swapped(Bits bits)
{
    if constexpr (sizeof(Bits) == 2) return __builtin_bswap16(bits);
    if constexpr (sizeof(Bits) == 4) return __builtin_bswap32(bits);
    if constexpr (sizeof(Bits) == 8) return __builtin_bswap64(bits);
    return bits;
}

template <class Bits>
void swap_each(std::span<std::byte> bytes)
{
    for (size_t at = 0; at + sizeof(Bits) <= bytes.size(); at += sizeof(Bits)) {
        Bits bits;
        std::memcpy(&bits, bytes.data() + at, sizeof(Bits));
        bits = swapped(bits);
        std::memcpy(bytes.data() + at, &bits, sizeof(Bits));
    }
}

void swap_bytes(std::span<std::byte> voxels, size_t voxel_bytes)
{
    if (voxel_bytes == 2) swap_each<uint16_t>(voxels);
    if (voxel_bytes == 4) swap_each<uint32_t>(voxels);
    if (voxel_bytes == 8) swap_each<uint64_t>(voxels);
}

/// Bytes from one voxel to the next along each axis of a stored chunk.
std::vector<size_t> strides_of(const ZarrMetadata& metadata)
{
    const size_t axes = metadata.chunks.size();
    std::vector<size_t> strides(axes);
    size_t stride = bytes_of(metadata.type);
    for (size_t i = 0; i < axes; ++i) {
        const size_t axis = metadata.is_fortran ? i : axes - 1 - i;
        strides[axis] = stride;
        stride *= size_t(metadata.chunks[axis]);
    }
    return strides;
}

template <class Bits>
void gather(const std::byte* from, const Size3& count, const std::array<size_t, 3>& stride, std::byte* to)
{
    for (int64_t z = 0; z < count.z; ++z) {
        for (int64_t y = 0; y < count.y; ++y) {
            const std::byte* row = from + size_t(z) * stride[2] + size_t(y) * stride[1];
            const auto bytes = size_t(count.x) * sizeof(Bits);
            if (stride[0] == sizeof(Bits)) {
                std::memcpy(to, row, bytes);
            } else {
                for (int64_t x = 0; x < count.x; ++x, row += stride[0]) {
                    std::memcpy(to + size_t(x) * sizeof(Bits), row, sizeof(Bits));
                }
            }
            to += bytes;
        }
    }
}

/// The stored bytes; nothing if there is no such file.
std::optional<std::vector<std::byte>> stored_bytes(const std::filesystem::path& path, int64_t longest)
{
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        if (errno == ENOENT) return std::nullopt;
        fail(path.string(), ": cannot be examined: ", reason_of(errno));
    }
    return read_file(path, longest);
}

/// Sets `count` voxels to `fill`.
void fill_voxels(std::byte* voxels, size_t count, std::span<const std::byte> fill)
{
    if (std::ranges::all_of(fill, [&](std::byte byte) { return byte == fill[0]; })) {
        std::memset(voxels, std::to_integer<int>(fill[0]), count * fill.size());
        return;
    }
    for (size_t i = 0; i < count; ++i) std::memcpy(voxels + i * fill.size(), fill.data(), fill.size());
}

}  // namespace

uint64_t checksum_of(std::span<const std::byte> stored)
{
    const uint64_t hash = XXH3_64bits(stored.data(), stored.size());
    return hash == 0 ? 1 : hash;
}

ZarrVolume::ZarrVolume(std::filesystem::path array, ZarrMetadata metadata, ZarrView view)
    : array_(std::move(array)), metadata_(std::move(metadata)), view_(std::move(view))
{
    view_.at.resize(metadata_.shape.size());
    for (int axis = 0; axis < 3; ++axis) {
        const size_t of_array = view_.xyz[size_t(axis)];
        size_[axis] = metadata_.shape[of_array];
        chunk_[axis] = metadata_.chunks[of_array];
        counts_[axis] = (size_[axis] - 1) / chunk_[axis] + 1;
    }
}

std::filesystem::path ZarrVolume::path_of(const Size3& chunk) const
{
    std::vector<int64_t> index(view_.at.size());
    for (size_t axis = 0; axis < index.size(); ++axis) index[axis] = view_.at[axis] / metadata_.chunks[axis];
    for (int axis = 0; axis < 3; ++axis) index[view_.xyz[size_t(axis)]] = chunk[axis];
    std::string key;
    for (const int64_t number : index) {
        if (!key.empty()) key += metadata_.separator;
        key += std::to_string(number);
    }
    return array_ / key;
}

Block ZarrVolume::load(const Size3& chunk) const
{
    const std::filesystem::path path = path_of(chunk);
    const auto stored = stored_bytes(path, longest_stored(int64_t(metadata_.chunk_bytes())));
    if (!checksums_.empty()) {
        const uint64_t expected = checksums_[size_t(index_of(chunk))];
        if (!stored && expected != 0) fail(path.string(), ": is missing; expected the chunk that the import wrote");
        if (stored && checksum_of(*stored) != expected) {
            fail(path.string(), ": is damaged, or another program changed it; expected what the import wrote");
        }
    }
    if (stored) return decoded(*stored, path.string());
    // An array that was removed must not look empty.
    if (!is_there()) {
        fail((array_ / ".zarray").string(), ": cannot be found any more: ", reason_of(errno),
             "; expected the array that was opened");
    }
    return {};
}

bool ZarrVolume::is_missing(const Size3& chunk) const
{
    if (!checksums_.empty()) return checksums_[size_t(index_of(chunk))] == 0;
    struct stat status {};
    return ::stat(path_of(chunk).c_str(), &status) != 0 && errno == ENOENT;
}

ChunkNames ZarrVolume::names() const
{
    ChunkNames names{.folder = array_, .separator = metadata_.separator};
    for (size_t axis = 0; axis < metadata_.shape.size(); ++axis) {
        names.counts.push_back((metadata_.shape[axis] - 1) / metadata_.chunks[axis] + 1);
        const bool is_of_volume = std::ranges::find(view_.xyz, axis) != view_.xyz.end();
        names.at.push_back(is_of_volume ? std::nullopt : std::optional(view_.at[axis] / metadata_.chunks[axis]));
    }
    return names;
}

bool ZarrVolume::list_stored(int64_t most, const std::function<void(const Size3&)>& take) const
{
    if (checksums_.empty())
        return list_chunks(names(), most, [&](std::span<const int64_t> numbers) {
            take({numbers[view_.xyz[0]], numbers[view_.xyz[1]], numbers[view_.xyz[2]]});
        });
    for (size_t i = 0; i < checksums_.size(); ++i) {
        if (checksums_[i] == 0) continue;
        if (--most < 0) return false;
        take(position_of(int64_t(i), counts_));
    }
    return true;
}

std::string ZarrVolume::stray_chunk() const
{
    const std::string name = shvr::stray_chunk(names());
    return name.empty() ? name : (array_ / name).string();
}

double ZarrVolume::fill() const
{
    double fill = 0.0;
    load_voxels(metadata_.type, metadata_.fill.data(), std::span(&fill, 1));
    return fill;
}

bool ZarrVolume::is_there() const
{
    return ::access((array_ / ".zarray").c_str(), F_OK) == 0;
}

Block ZarrVolume::decoded(std::span<const std::byte> stored, const std::string& name) const
{
    check_stored_size(metadata_.compressor.kind, stored.size(), metadata_.chunk_bytes(), name);
    Block chunk(metadata_.chunk_bytes());
    decompress_chunk(metadata_.compressor.kind, stored, chunk, name);
    if (metadata_.big_endian) swap_bytes(chunk, bytes_of(metadata_.type));
    return arranged(std::move(chunk));
}

Block ZarrVolume::arranged(Block chunk) const
{
    const std::vector<size_t> strides = strides_of(metadata_);
    const std::array<size_t, 3> stride{strides[view_.xyz[0]], strides[view_.xyz[1]], strides[view_.xyz[2]]};
    const size_t voxel_bytes = bytes_of(metadata_.type);
    const auto row = size_t(chunk_.x) * voxel_bytes;
    const size_t slice = row * size_t(chunk_.y);
    const size_t bytes = slice * size_t(chunk_.z);
    if (bytes == chunk.size() && stride == std::array<size_t, 3>{voxel_bytes, row, slice}) return chunk;

    size_t first = 0;
    for (size_t axis = 0; axis < strides.size(); ++axis) {
        if (std::ranges::find(view_.xyz, axis) != view_.xyz.end()) continue;
        first += size_t(view_.at[axis] % metadata_.chunks[axis]) * strides[axis];
    }
    Block block(bytes);
    const std::byte* const from = chunk.data() + first;
    if (voxel_bytes == 1) gather<uint8_t>(from, chunk_, stride, block.data());
    if (voxel_bytes == 2) gather<uint16_t>(from, chunk_, stride, block.data());
    if (voxel_bytes == 4) gather<uint32_t>(from, chunk_, stride, block.data());
    if (voxel_bytes == 8) gather<uint64_t>(from, chunk_, stride, block.data());
    return block;
}

void ZarrVolume::read(const VoxelBox& box, std::span<std::byte> voxels,
                      const std::function<std::shared_ptr<const Block>(const Size3& chunk)>& get) const
{
    const auto voxel_bytes = int64_t(bytes_of(metadata_.type));
    const std::span<const std::byte> fill(metadata_.fill.data(), size_t(voxel_bytes));
    const Size3 extent = box.size();
    SHVR_CHECK(glm::all(glm::greaterThanEqual(box.lower, Size3(0))) && glm::all(glm::lessThanEqual(box.upper, size_)) &&
               glm::all(glm::greaterThan(extent, Size3(0))));
    SHVR_CHECK(int64_t(voxels.size()) == extent.x * extent.y * extent.z * voxel_bytes, voxels.size());

    const Size3 first = box.lower / chunk_;
    const Size3 end = (box.upper - int64_t{1}) / chunk_ + int64_t{1};
    Size3 at;
    for (at.z = first.z; at.z < end.z; ++at.z) {
        for (at.y = first.y; at.y < end.y; ++at.y) {
            for (at.x = first.x; at.x < end.x; ++at.x) {
                const std::shared_ptr<const Block> block = get(at);
                const Size3 origin = at * chunk_;
                const Size3 lower = glm::max(box.lower, origin);
                const Size3 upper = glm::min(box.upper, origin + chunk_);
                const auto run = size_t((upper.x - lower.x) * voxel_bytes);
                for (int64_t z = lower.z; z < upper.z; ++z) {
                    for (int64_t y = lower.y; y < upper.y; ++y) {
                        const int64_t to =
                            lower.x - box.lower.x + extent.x * (y - box.lower.y + extent.y * (z - box.lower.z));
                        std::byte* const row = voxels.data() + to * voxel_bytes;
                        if (block->empty()) {
                            fill_voxels(row, run / size_t(voxel_bytes), fill);
                            continue;
                        }
                        const int64_t from = lower.x - origin.x + chunk_.x * (y - origin.y + chunk_.y * (z - origin.z));
                        std::memcpy(row, block->data() + from * voxel_bytes, run);
                    }
                }
            }
        }
    }
}

}  // namespace shvr
