#pragma once
// What a project's folder knows of its volume besides the voxels, as far as it can be read; nothing of it is needed.
// For source_ome_zarr.cpp.

#include <filesystem>
#include <optional>
#include <vector>

#include "engine/formats/zarr/project.h"
#include "engine/formats/zarr/zarr_volume.h"

namespace shvr {

struct ProjectKnowledge {
    std::optional<ProjectRecord> record{};
    std::vector<std::vector<std::byte>> ranges{};  ///< by level; may be empty
};

/// Puts what the record says of the volume into `info`, and makes `volumes`, its levels, expect their checksums. What
/// is damaged is left out, with a warning: it costs what it hits, not the image.
ProjectKnowledge read_project_knowledge(const std::filesystem::path& folder, VolumeInfo& info,
                                        std::vector<ZarrVolume>& volumes);

/// Of a brick of a level that is inside it; nothing where that is not known.
std::optional<ValueRange> range_of(const ProjectKnowledge& knowledge, const VolumeInfo& info, int level,
                                   const Size3& brick);

}  // namespace shvr
