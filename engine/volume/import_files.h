#pragma once
// The small files of a project that an import writes, and what tells one import from another. For import_volume.cpp.

#include <string>

#include "engine/volume/import_volume.h"
#include "engine/volume/zarr_volume.h"

namespace shvr {

/// A level's array, as it will be written.
ZarrVolume import_level(const std::filesystem::path& project, const VolumeInfo& info, int level,
                        const ZarrCompressor& compressor);

/// PROJECT/.zgroup, PROJECT/.zattrs and PROJECT/shvr/session.json.
std::string import_group();
std::string import_attributes(const std::string& name, const VolumeInfo& info, int levels, Halving how);
std::string import_session();

/// Equal for imports that give equal projects: what the source is (the names, sizes and times of its files as well) and
/// what is done to it.
std::string import_identity(const VolumeSource& source, const std::filesystem::path& origin,
                            const ImportOptions& options);

}  // namespace shvr
