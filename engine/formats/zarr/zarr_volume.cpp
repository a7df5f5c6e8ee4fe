#include "engine/formats/zarr/zarr_volume.h"

#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {
namespace {

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

ZarrVolume::ZarrVolume(ZarrPlace array, ZarrMetadata metadata, ZarrView view)
    : chunks_(std::make_shared<const ZarrChunks>(std::move(array), std::move(metadata))), view_(std::move(view))
{
    const ZarrMetadata& of_array = chunks_->metadata();
    view_.at.resize(of_array.shape.size());
    for (int axis = 0; axis < 3; ++axis) {
        const size_t along = view_.xyz[size_t(axis)];
        size_[axis] = of_array.shape[along];
        chunk_[axis] = of_array.chunks[along];
        counts_[axis] = (size_[axis] - 1) / chunk_[axis] + 1;
    }
}

/// Returns a chunk's index along each axis of the array, from its index along x, y and z.
std::vector<int64_t> ZarrVolume::numbers_of(const Size3& chunk) const
{
    std::vector<int64_t> numbers(view_.at.size());
    for (size_t axis = 0; axis < numbers.size(); ++axis) numbers[axis] = view_.at[axis] / metadata().chunks[axis];
    for (int axis = 0; axis < 3; ++axis) numbers[view_.xyz[size_t(axis)]] = chunk[axis];
    return numbers;
}

std::filesystem::path ZarrVolume::path_of(const Size3& chunk) const
{
    return chunks_->path_of(numbers_of(chunk));
}

uint64_t ZarrVolume::expected_checksum(const Size3& chunk) const
{
    const auto index = uint64_t(index_of(chunk));
    const auto found = std::ranges::lower_bound(*expected_, index, {}, &StoredChunk::index);
    return found != expected_->end() && found->index == index ? found->checksum : 0;
}

Block ZarrVolume::load(const Size3& chunk) const
{
    // The table states that the chunk is missing, which saves the round trip of a request.
    if (is_remote() && expected_ && expected_checksum(chunk) == 0) return {};
    const std::vector<int64_t> numbers = numbers_of(chunk);
    const auto stored = chunks_->read(numbers);
    if (expected_) {
        const uint64_t expected = expected_checksum(chunk);
        const std::string name = chunks_->name_of(numbers);
        if (!stored && expected != 0) fail(name, ": is missing; expected the chunk that the import wrote");
        if (stored && checksum_of(*stored) != expected)
            fail(name, ": is damaged, or another program changed it; expected what the import wrote");
    }
    if (stored) return arranged(chunks_->decoded(*stored, chunks_->name_of(numbers)));
    // Distinguishes an array that was removed from an array without chunks.
    if (!is_there()) {
        fail(chunks_->metadata_path().string(), ": no longer exists: ", reason_of(ENOENT),
             "; expected the array that was opened");
    }
    return {};
}

void ZarrVolume::prepare(std::span<const Size3> chunks) const
{
    std::vector<std::vector<int64_t>> numbers;
    for (const Size3& chunk : chunks)
        if (!expected_ || expected_checksum(chunk) != 0) numbers.push_back(numbers_of(chunk));
    chunks_->prepare(numbers);
}

bool ZarrVolume::is_missing(const Size3& chunk) const
{
    if (expected_) return expected_checksum(chunk) == 0;
    return chunks_->is_missing(numbers_of(chunk));
}

bool ZarrVolume::list_stored(int64_t most, const std::function<void(const Size3&)>& take) const
{
    if (!expected_) {
        std::vector<std::optional<int64_t>> at(view_.at.size());
        for (size_t axis = 0; axis < at.size(); ++axis) {
            const bool is_of_volume = std::ranges::find(view_.xyz, axis) != view_.xyz.end();
            if (!is_of_volume) at[axis] = view_.at[axis] / metadata().chunks[axis];
        }
        return chunks_->list(at, most, [&](std::span<const int64_t> numbers) {
            take({numbers[view_.xyz[0]], numbers[view_.xyz[1]], numbers[view_.xyz[2]]});
        });
    }
    for (const StoredChunk& chunk : *expected_) {
        if (--most < 0) return false;
        take(position_of(int64_t(chunk.index), counts_));
    }
    return true;
}

double ZarrVolume::fill() const
{
    double fill = 0.0;
    load_voxels(metadata().type, metadata().fill.data(), std::span(&fill, 1));
    return fill;
}

Block ZarrVolume::arranged(Block chunk) const
{
    const ZarrMetadata& of_array = metadata();
    const std::vector<size_t> strides = of_array.strides();
    const std::array<size_t, 3> stride{strides[view_.xyz[0]], strides[view_.xyz[1]], strides[view_.xyz[2]]};
    const size_t voxel_bytes = bytes_of(of_array.type);
    const auto row = size_t(chunk_.x) * voxel_bytes;
    const size_t slice = row * size_t(chunk_.y);
    const size_t bytes = slice * size_t(chunk_.z);
    if (bytes == chunk.size() && stride == std::array<size_t, 3>{voxel_bytes, row, slice}) return chunk;

    size_t first = 0;
    for (size_t axis = 0; axis < strides.size(); ++axis) {
        if (std::ranges::find(view_.xyz, axis) != view_.xyz.end()) continue;
        first += size_t(view_.at[axis] % of_array.chunks[axis]) * strides[axis];
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
    const auto voxel_bytes = int64_t(bytes_of(metadata().type));
    const std::span<const std::byte> fill(metadata().fill.data(), size_t(voxel_bytes));
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
