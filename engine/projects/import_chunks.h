#pragma once
// The chunks of all levels of a project under construction, as files in its folder, and their checksums. Chunks of a
// level with shards are loose files in PROJECT/shvr/chunks until they are packed into shards.

#include <atomic>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/formats/zarr/ome_zarr.h"
#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/import_state.h"

namespace shvr {

class ImportChunks {
public:
    ImportChunks(const std::filesystem::path& project, const VolumeInfo& info, int levels, OmeZarrVersion version,
                 const ZarrCompressor& compressor, bool has_shards, int workers);

    /// Compresses and writes the voxels of a chunk; writes no file if all of them are 0. Different workers may write
    /// different chunks at once.
    void write(int level, const Size3& chunk, std::span<const std::byte> voxels, int worker);

    int64_t shards(int level) const;  ///< 0: the level has no shards
    /// To be called once all chunks of the level are written: merges the files of a shard's chunks into the shard's
    /// file, and removes them. Does nothing if that is done already. Writes no file if no chunk of the shard has one.
    /// Any thread may pack any shard.
    void pack(int level, int64_t shard);
    /// To be called once all shards are packed.
    void remove_loose() const;

    int levels() const { return int(levels_.size()); }
    Size3 counts(int level) const { return of(level).volume.counts(); }
    const ZarrMetadata& metadata(int level) const { return of(level).volume.metadata(); }
    /// Checksums, indexed by ZarrVolume::index_of; 0 if there is no file.
    const std::vector<uint64_t>& checksums(int level) const { return of(level).checksums; }

    int64_t all() const;                      ///< chunks
    int64_t stored() const;                   ///< chunks that have a file
    int64_t bytes() const { return bytes_; }  ///< total size of the files

    /// To be called only while nothing is being written.
    void save(StateWriter& state) const;
    void load(StateReader& state);

private:
    struct Level {
        ZarrVolume volume;  ///< used for names and places; nothing is read through it
        ZarrVolume loose;   ///< the same array without shards, into which `write` puts chunks
        std::vector<uint64_t> checksums;
    };
    std::filesystem::path loose_folder() const { return project_ / "shvr" / "chunks"; }
    const Level& of(int level) const { return levels_[size_t(level)]; }

    std::filesystem::path project_;
    ZarrCompressor compressor_;
    std::vector<Level> levels_;
    std::vector<std::vector<std::byte>> compressed_;  ///< by worker
    std::atomic<int64_t> bytes_ = 0;
};

}  // namespace shvr
