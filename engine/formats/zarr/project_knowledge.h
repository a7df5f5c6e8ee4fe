#pragma once
// The data that a project folder states about its volume in addition to the voxels. All of these data are optional, and
// unreadable parts are left out. For source_ome_zarr.cpp.

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

/// Puts the record's data about the volume into `info`, and gives `volumes`, the image's levels, the checksums to
/// verify. Damaged parts are ignored, with a warning; the image still opens.
ProjectKnowledge read_project_knowledge(const std::filesystem::path& folder, VolumeInfo& info,
                                        std::vector<ZarrVolume>& volumes);

/// Returns the range of a brick; the brick must lie inside the level. Null if the range is unknown.
std::optional<ValueRange> range_of(const ProjectKnowledge& knowledge, const VolumeInfo& info, int level,
                                   const Size3& brick);

}  // namespace shvr
