#pragma once
// Opens an OME-Zarr of a store that is open already. Any thread.

#include "engine/formats/zarr/store/zarr_store.h"
#include "engine/volume/source.h"

namespace shvr {

/// As open_ome_zarr (engine/formats/readers.h), for the place in a store that the path leads to.
std::unique_ptr<VolumeSource> open_ome_zarr_at(const ZarrPlace& place, const std::filesystem::path& path,
                                               const OpenOptions& options);

}  // namespace shvr
