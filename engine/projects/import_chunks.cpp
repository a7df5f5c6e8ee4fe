#include "engine/projects/import_chunks.h"

#include <algorithm>
#include <cstring>

#include "engine/formats/zarr/zarr_codec.h"
#include "engine/projects/import_files.h"
#include "engine/projects/part_folder.h"

namespace shvr {
namespace {

using Bytes = std::span<const std::byte>;

bool is_empty(Bytes chunk)
{
    // Compares the chunk with itself, shifted by one byte.
    return chunk[0] == std::byte{0} && std::memcmp(chunk.data(), chunk.data() + 1, chunk.size() - 1) == 0;
}

}  // namespace

ImportChunks::ImportChunks(const std::filesystem::path& project, const VolumeInfo& info, int levels,
                           OmeZarrVersion version, const ZarrCompressor& compressor, int workers)
    : compressor_(compressor), compressed_(size_t(workers))
{
    for (int level = 0; level < levels; ++level) {
        ZarrVolume volume = import_level(project, info, level, version, compressor);
        const Size3 counts = volume.counts();
        levels_.push_back({std::move(volume), std::vector<uint64_t>(size_t(counts.x * counts.y * counts.z))});
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
    write_part_file(to.volume.path_of(chunk), stored);
    to.checksums[index] = checksum_of(stored);
    bytes_ += int64_t(stored.size());
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
