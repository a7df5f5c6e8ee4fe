#pragma once
// Makes the levels of a label image only where something is stored: for 2^20
// voxels a side and one stored chunk, it writes 16 chunks. The files equal
// those of a dense import, byte for byte. For import_volume.cpp. One thread.

#include <filesystem>
#include <optional>
#include <vector>

#include "engine/formats/zarr/metadata/zarr_metadata.h"
#include "engine/formats/zarr/ome_zarr.h"
#include "engine/volume/source.h"

namespace shvr {

/// The chunks of IMPORT_CHUNK^3 voxels that stored blocks touch, in an order in which those below one chunk of a
/// coarser level are adjacent. Null if the source does not know what it stores, if the fill value is not 0, or if a
/// dense import is cheaper: if they are more than an eighth of all.
std::optional<std::vector<Size3>> sparse_chunks(const VolumeSource& source);

struct SparseLevelFiles {
    int levels = 1;
    int64_t chunks = 0;  ///< number in all levels
    int64_t stored = 0;  ///< that have a file
    int64_t bytes = 0;   ///< total size of these files
};
/// Writes chunks and metadata of all levels into a folder; a voxel of a coarser level is the most frequent label of
/// those below it. `info`: as stated in the files; `progress` reports the completed fraction of `chunks`.
SparseLevelFiles write_sparse_levels(const VolumeSource& source, const VolumeInfo& info,
                                     const std::vector<Size3>& chunks, const std::filesystem::path& folder,
                                     OmeZarrVersion version, const ZarrCompressor& compressor,
                                     const Progress& progress);

}  // namespace shvr
