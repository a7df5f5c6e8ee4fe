#pragma once
// Files and checksums of the chunks of all levels of a project under construction. Where a level has shards, its chunks
// are separate ("loose") files in PROJECT/shvr/chunks until they are packed into shards.

#include <atomic>
#include <filesystem>
#include <mutex>
#include <span>
#include <vector>

#include "engine/formats/zarr/ome_zarr.h"
#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/projects/levels/import_state.h"

namespace shvr {

class ImportChunks {
public:
    /// `fill`: the value of voxels in chunks that are not stored.
    ImportChunks(const std::filesystem::path& project, const VolumeInfo& info, int levels, OmeZarrVersion version,
                 const ZarrCompressor& compressor, bool has_shards, int workers, const FillVoxel& fill = {});

    /// Compresses and writes the voxels of a chunk, unless all of them are the fill value. Different workers may write
    /// different chunks at the same time. Each chunk is written at most once.
    void write(int level, const Size3& chunk, std::span<const std::byte> voxels, int worker);
    /// Call this once all chunks of all levels are written. The members below are valid only after this call.
    void finish();

    /// Returns the numbers of those shards of a level that contain chunks; empty if the level has no shards.
    std::vector<int64_t> shards(int level) const;
    /// Merges the chunk files of a shard into the shard's file, and deletes them. Does nothing if the shard is already
    /// packed. Any thread may pack any shard.
    void pack(int level, int64_t shard);
    /// Call once all shards are packed.
    void remove_loose() const;

    int levels() const { return int(levels_.size()); }
    Size3 counts(int level) const { return of(level).volume.counts(); }
    const ZarrMetadata& metadata(int level) const { return of(level).volume.metadata(); }
    /// The chunks that have a file, ascending.
    const std::vector<StoredChunk>& written(int level) const { return of(level).written; }

    int64_t all() const;                      ///< number of chunks
    int64_t stored() const;                   ///< number of chunks that have a file
    int64_t bytes() const { return bytes_; }  ///< total size of the files

    /// Call only while nothing is being written.
    void save(StateWriter& state) const;
    void load(StateReader& state);
    /// Adds the chunks that another process has written, whose `save` made the state: links their files, or copies them
    /// where the file system has no links.
    void merge(StateReader& state, const ImportChunks& from);

private:
    struct Level {
        ZarrVolume volume;  ///< only provides names and paths; never read
        ZarrVolume loose;   ///< the same array without shards, to which `write` writes chunks
        std::vector<StoredChunk> written{};
    };
    std::filesystem::path loose_folder() const { return project_ / "shvr" / "chunks"; }
    const Level& of(int level) const { return levels_[size_t(level)]; }

    std::filesystem::path project_;
    ZarrCompressor compressor_;
    std::vector<Level> levels_;
    FillVoxel fill_;
    std::vector<std::vector<std::byte>> compressed_;  ///< by worker
    std::mutex mutex_;                                ///< guards `written`
    std::atomic<int64_t> bytes_ = 0;
};

}  // namespace shvr
