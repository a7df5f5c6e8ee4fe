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

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Bytes = std::span<const std::byte>;

static_assert(std::endian::native == std::endian::little, "indices of shards are written as they are in memory");

bool is_empty(Bytes chunk)
{
    // Compares the chunk with itself, shifted by one byte.
    return chunk[0] == std::byte{0} && std::memcmp(chunk.data(), chunk.data() + 1, chunk.size() - 1) == 0;
}

/// Chunks of a full shard.
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

}  // namespace

ImportChunks::ImportChunks(const std::filesystem::path& project, const VolumeInfo& info, int levels,
                           OmeZarrVersion version, const ZarrCompressor& compressor, bool has_shards, int workers)
    : project_(project), compressor_(compressor), compressed_(size_t(workers))
{
    for (int level = 0; level < levels; ++level) {
        ZarrVolume volume = import_level(project, info, level, version, compressor, has_shards);
        const bool is_sharded = volume.metadata().sharding.has_value();
        ZarrVolume loose = import_level(is_sharded ? loose_folder() : project, info, level, version, compressor, false);
        const Size3 counts = volume.counts();
        levels_.push_back(
            {std::move(volume), std::move(loose), std::vector<uint64_t>(size_t(counts.x * counts.y * counts.z))});
    }
}

void ImportChunks::write(int level, const Size3& chunk, Bytes voxels, int worker)
{
    Level& to = levels_[size_t(level)];
    const auto index = size_t(to.volume.index_of(chunk));
    if (is_empty(voxels)) {
        to.checksums[index] = 0;
        return;
    }
    const Bytes stored =
        compress_chunk(compressor_, voxels, bytes_of(to.volume.metadata().type), compressed_[size_t(worker)]);
    write_part_file(to.loose.path_of(chunk), stored);
    to.checksums[index] = checksum_of(stored);
    bytes_ += int64_t(stored.size());
}

int64_t ImportChunks::shards(int level) const
{
    if (!metadata(level).sharding) return 0;
    const Size3 counts = shard_counts(of(level).volume);
    return counts.x * counts.y * counts.z;
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
                if (from.checksums[size_t(from.volume.index_of(chunk))] != 0) stored.push_back(chunk);
    if (stored.empty()) return;
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
    for (const Level& level : levels_) chunks += int64_t(level.checksums.size());
    return chunks;
}

int64_t ImportChunks::stored() const
{
    int64_t chunks = 0;
    for (const Level& level : levels_) {
        chunks += int64_t(std::ranges::count_if(level.checksums, [](uint64_t checksum) { return checksum != 0; }));
    }
    return chunks;
}

void ImportChunks::save(StateWriter& state) const
{
    state.put_all(std::vector<int64_t>{bytes_});
    for (const Level& level : levels_) state.put_all(level.checksums);
}

void ImportChunks::load(StateReader& state)
{
    std::vector<int64_t> bytes(1);
    state.take_all(bytes);
    bytes_ = bytes[0];
    for (Level& level : levels_) state.take_all(level.checksums);
}

}  // namespace shvr
