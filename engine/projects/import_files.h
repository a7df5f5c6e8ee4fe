#pragma once
// The small files of a project that an import writes, and the identity of an import. For import_volume.cpp.

#include <string>

#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// The array of a level, as it will be written.
ZarrVolume import_level(const std::filesystem::path& project, const VolumeInfo& info, int level,
                        const ZarrCompressor& compressor);

/// PROJECT/.zgroup, PROJECT/.zattrs and PROJECT/shvr/session.json.
std::string import_group();
/// `labels`: additional attributes of a label image, or null.
std::string import_attributes(const std::string& name, const VolumeInfo& info, int levels, Halving how,
                              const LabelImage* labels);
std::string import_session();

/// `folder` without dots. Fails if it exists and is not a replaceable label image, or if it belongs to an image's
/// labels and that image's list of labels cannot be read. Creates the parent folder.
std::filesystem::path label_image_target(const std::filesystem::path& folder);
/// Whether it is IMAGE/labels/NAME of an OME-Zarr image.
bool belongs_to_image(const std::filesystem::path& target);
/// Adds it to IMAGE/labels/.zattrs, which is created if it is missing.
void list_label_image(const std::filesystem::path& target);

/// Equal for imports that give equal projects: covers the source (including the names, sizes and times of its files)
/// and the processing applied to it.
std::string import_identity(const VolumeSource& source, const std::filesystem::path& origin,
                            const ImportOptions& options);

}  // namespace shvr
