#pragma once
// The data that a project folder states about its volume, in addition to the voxels. All of it is optional, and
// unreadable parts are ignored. For source_ome_zarr.cpp.

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

/// Copies the record's data about the volume into `info`, and passes the checksums to verify to `volumes`, the image's
/// levels. Damaged parts are ignored with a warning, so the image still opens; a project of a newer version is refused.
ProjectKnowledge read_project_knowledge(const std::filesystem::path& folder, VolumeInfo& info,
                                        std::vector<ZarrVolume>& volumes);

/// The same for an image at an address, whose tables are requested in one round; large ones are not read. Tables that
/// cannot be read are left out with a warning, and so is the annotation of a project.
ProjectKnowledge read_remote_knowledge(const ZarrPlace& place, VolumeInfo& info, std::vector<ZarrVolume>& volumes);

/// Returns the value range of a brick, which must lie inside the level; null if the range is unknown.
std::optional<ValueRange> range_of(const ProjectKnowledge& knowledge, const VolumeInfo& info, int level,
                                   const Size3& brick);

}  // namespace shvr
