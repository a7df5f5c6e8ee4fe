#include "engine/projects/import_chunks.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/formats/zarr/crc32c.h"
#include "engine/formats/zarr/zarr_codec.h"
#include "engine/projects/import_files.h"
#include "engine/projects/part_folder.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Bytes = std::span<const std::byte>;

static_assert(std::endian::native == std::endian::little, "indices of shards are written as they are in memory");

bool consists_of(Bytes voxel, Bytes chunk)
{
    // All voxels are equal if the first equals `voxel` and the chunk equals itself shifted by one voxel.
    return std::memcmp(chunk.data(), voxel.data(), voxel.size()) == 0 &&
           std::memcmp(chunk.data(), chunk.data() + voxel.size(), chunk.size() - voxel.size()) == 0;
}

/// Returns how many chunks a full shard has along each axis.
Size3 shard_chunks(const ZarrVolume& volume)
{
    const std::vector<int64_t>& shape = volume.metadata().sharding->shape;
    return Size3(shape[2], shape[1], shape[0]) / volume.chunk();
}

Size3 shard_counts(const ZarrVolume& volume)
{
    const Size3 along = shard_chunks(volume);
    return (volume.counts() + along - int64_t{1}) / along;
}

void link_or_copy(const fs::path& file, const fs::path& target)
{
    std::error_code error;
    fs::create_hard_link(file, target, error);
    if (!error) return;
    fs::create_directories(target.parent_path(), error);
    fs::create_hard_link(file, target, error);
    if (!error) return;
    fs::copy_file(file, target, fs::copy_options::overwrite_existing, error);
    if (error) fail(file.string(), ": cannot be copied to ", target.string(), ": ", error.message());
}

}  // namespace

ImportChunks::ImportChunks(const std::filesystem::path& project, const VolumeInfo& info, int levels,
                           OmeZarrVersion version, const ZarrCompressor& compressor, bool has_shards, int workers,
                           const FillVoxel& fill)
    : project_(project), compressor_(compressor), fill_(fill), compressed_(size_t(workers))
{
    for (int level = 0; level < levels; ++level) {
        ZarrVolume volume = import_level(project, info, level, version, compressor, has_shards, fill);
        const bool is_sharded = volume.metadata().sharding.has_value();
        ZarrVolume loose =
            import_level(is_sharded ? loose_folder() : project, info, level, version, compressor, false, fill);
        levels_.push_back({std::move(volume), std::move(loose)});
    }
}

void ImportChunks::write(int level, const Size3& chunk, Bytes voxels, int worker)
{
    Level& to = levels_[size_t(level)];
    const size_t voxel_bytes = bytes_of(to.volume.metadata().type);
    if (consists_of(Bytes(fill_).first(voxel_bytes), voxels)) return;
    const Bytes stored = compress_chunk(compressor_, voxels, voxel_bytes, compressed_[size_t(worker)]);
    write_part_file(to.loose.path_of(chunk), stored);
    const StoredChunk written{.index = uint64_t(to.volume.index_of(chunk)), .checksum = checksum_of(stored)};
    const std::scoped_lock lock(mutex_);
    to.written.push_back(written);
    bytes_ += int64_t(stored.size());
}

void ImportChunks::finish()
{
    for (Level& level : levels_) std::ranges::sort(level.written, {}, &StoredChunk::index);
}

std::vector<int64_t> ImportChunks::shards(int level) const
{
    if (!metadata(level).sharding) return {};
    const ZarrVolume& volume = of(level).volume;
    std::vector<int64_t> shards;
    for (const StoredChunk& chunk : of(level).written)
        shards.push_back(
            index_of(position_of(int64_t(chunk.index), volume.counts()) / shard_chunks(volume), shard_counts(volume)));
    std::ranges::sort(shards);
    const auto repeated = std::ranges::unique(shards);
    shards.erase(repeated.begin(), repeated.end());
    return shards;
}

void ImportChunks::pack(int level, int64_t shard)
{
    const Level& from = of(level);
    const Size3 along = shard_chunks(from.volume);
    const Size3 first = position_of(shard, shard_counts(from.volume)) * along;
    const Size3 last = glm::min(first + along, from.volume.counts());
    const fs::path path = from.volume.path_of(first);
    const auto index_bytes = size_t(metadata(level).sharding->index_bytes(metadata(level).chunks));
    std::vector<std::byte> index(index_bytes, std::byte{0xff});  // all ones: not stored
    std::vector<Size3> stored;
    for (Size3 chunk = first; chunk.z < last.z; ++chunk.z)
        for (chunk.y = first.y; chunk.y < last.y; ++chunk.y)
            for (chunk.x = first.x; chunk.x < last.x; ++chunk.x)
                if (std::ranges::binary_search(from.written, uint64_t(from.volume.index_of(chunk)), {},
                                               &StoredChunk::index))
                    stored.push_back(chunk);
    bytes_ += int64_t(index_bytes);

    std::error_code error;
    if (!fs::exists(path, error)) {
        const fs::path unfinished = loose_folder() / sentence(level, "-shard-", shard);
        AtomicWriter writer(unfinished);
        uint64_t at = 0;
        for (const Size3& chunk : stored) {
            const std::vector<std::byte> bytes =
                read_file(from.loose.path_of(chunk), longest_stored(int64_t(metadata(level).chunk_bytes())));
            writer.append(bytes);
            const uint64_t part[] = {at, bytes.size()};
            std::memcpy(index.data() + sizeof(part) * size_t(index_of(chunk - first, along)), part, sizeof(part));
            at += bytes.size();
        }
        const uint32_t checksum = crc32c(std::span(index).first(index_bytes - sizeof(uint32_t)));
        std::memcpy(index.data() + index_bytes - sizeof(checksum), &checksum, sizeof(checksum));
        writer.append(index);
        writer.commit();
        fs::create_directories(path.parent_path(), error);
        if (!error) fs::rename(unfinished, path, error);
        if (error) fail(path.string(), ": cannot be created: ", error.message());
    }
    for (const Size3& chunk : stored) fs::remove(from.loose.path_of(chunk), error);  // otherwise remove_loose() does it
}

void ImportChunks::remove_loose() const
{
    std::error_code error;
    fs::remove_all(loose_folder(), error);
    if (error) fail(loose_folder().string(), ": cannot be deleted: ", error.message());
}

int64_t ImportChunks::all() const
{
    int64_t chunks = 0;
    for (const Level& level : levels_) {
        const Size3 counts = level.volume.counts();
        chunks += counts.x * counts.y * counts.z;
    }
    return chunks;
}

int64_t ImportChunks::stored() const
{
    int64_t chunks = 0;
    for (const Level& level : levels_) chunks += int64_t(level.written.size());
    return chunks;
}

void ImportChunks::save(StateWriter& state) const
{
    state.put_all(std::vector<int64_t>{bytes_});
    for (const Level& level : levels_) state.put_all(level.written);
}

void ImportChunks::load(StateReader& state)
{
    std::vector<int64_t> bytes(1);
    state.take_all(bytes);
    bytes_ = bytes[0];
    for (Level& level : levels_) level.written = state.take_list<StoredChunk>();
}

void ImportChunks::merge(StateReader& state, const ImportChunks& from)
{
    std::vector<int64_t> bytes(1);
    state.take_all(bytes);
    bytes_ += bytes[0];
    for (int number = 0; number < levels(); ++number) {
        Level& level = levels_[size_t(number)];
        const ZarrVolume& loose = from.of(number).loose;
        for (const StoredChunk& chunk : state.take_list<StoredChunk>()) {
            const Size3 counts = level.volume.counts();
            if (int64_t(chunk.index) >= counts.x * counts.y * counts.z) state.refuse();
            const Size3 position = position_of(int64_t(chunk.index), counts);
            link_or_copy(loose.path_of(position), level.loose.path_of(position));
            level.written.push_back(chunk);
        }
    }
}

}  // namespace shvr
