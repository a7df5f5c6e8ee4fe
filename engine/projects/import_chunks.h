#pragma once
// The chunks of all levels of a project that is being made, as files in its folder, and their checksums.

#include <atomic>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/import_state.h"

namespace shvr {

class ImportChunks {
public:
    ImportChunks(const std::filesystem::path& project, const VolumeInfo& info, int levels,
                 const ZarrCompressor& compressor, int workers);

    /// Compresses and writes the voxels of a chunk; there is no file where all of them are 0. Different chunks may be
    /// written at once, by different workers.
    void write(int level, const Size3& chunk, std::span<const std::byte> voxels, int worker);

    int levels() const { return static_cast<int>(levels_.size()); }
    Size3 counts(int level) const { return of(level).volume.counts(); }
    const ZarrMetadata& metadata(int level) const { return of(level).volume.metadata(); }
    /// By ZarrVolume::index_of; 0 where there is no file.
    const std::vector<uint64_t>& checksums(int level) const { return of(level).checksums; }

    int64_t all() const;                      ///< chunks
    int64_t stored() const;                   ///< those that have a file
    int64_t bytes() const { return bytes_; }  ///< of all files

    /// While nothing is written.
    void save(StateWriter& state) const;
    void load(StateReader& state);

private:
    struct Level {
        ZarrVolume volume;  ///< names and places; nothing is read through it
        std::vector<uint64_t> checksums;
    };
    const Level& of(int level) const { return levels_[static_cast<size_t>(level)]; }

    ZarrCompressor compressor_;
    std::vector<Level> levels_;
    std::vector<std::vector<std::byte>> compressed_;  ///< by worker
    std::atomic<int64_t> bytes_ = 0;
};

}  // namespace shvr
