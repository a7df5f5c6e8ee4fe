#pragma once
// What a project folder states about its volume in addition to the voxels, as far as it can be read; all of it is
// optional. For source_ome_zarr.cpp.

#include <filesystem>
#include <optional>
#include <vector>

#include "engine/formats/zarr/project.h"
#include "engine/formats/zarr/zarr_volume.h"

namespace shvr {

struct ProjectKnowledge {
    std::optional<ProjectRecord> record{};
    std::vector<std::optional<ProjectTable>> ranges{};  ///< by level
};

/// Puts the record's data about the volume into `info`, and sets the checksums that `volumes`, its levels, verify.
/// Damaged parts are ignored, with a warning; the image still opens.
ProjectKnowledge read_project_knowledge(const std::filesystem::path& folder, VolumeInfo& info,
                                        std::vector<ZarrVolume>& volumes);

/// The range of a brick of a level, which must lie inside it; null if unknown.
std::optional<ValueRange> range_of(const ProjectKnowledge& knowledge, const VolumeInfo& info, int level,
                                   const Size3& brick);

}  // namespace shvr
