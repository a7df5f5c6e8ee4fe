#pragma once
// Metadata of an array of Zarr version 3 (zarr.json). For zarr_metadata.cpp. Any thread may call these.

#include <string>

#include "engine/formats/zarr/metadata/zarr_metadata.h"

namespace shvr {

ZarrMetadata read_zarr_v3(const ZarrPlace& array);
std::string zarr_v3_text(const ZarrMetadata& metadata);

}  // namespace shvr
