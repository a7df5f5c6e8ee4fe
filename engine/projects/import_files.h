#pragma once
// The small files of a project that an import writes, and what tells one import from another. For import_volume.cpp.

#include <string>

#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// A level's array, as it will be written.
ZarrVolume import_level(const std::filesystem::path& project, const VolumeInfo& info, int level,
                        const ZarrCompressor& compressor);

/// PROJECT/.zgroup, PROJECT/.zattrs and PROJECT/shvr/session.json.
std::string import_group();
/// `labels`: what is said of a label image besides, or null.
std::string import_attributes(const std::string& name, const VolumeInfo& info, int levels, Halving how,
                              const LabelImage* labels);
std::string import_session();

/// `folder` without dots. Fails where it is there and is no label image that may be replaced, or where it is to be one
/// of an image's labels and the image's list of them cannot be read. Makes the folder that it is in.
std::filesystem::path label_image_target(const std::filesystem::path& folder);
/// Whether it is IMAGE/labels/NAME of an OME-Zarr image.
bool belongs_to_image(const std::filesystem::path& target);
/// Adds it to IMAGE/labels/.zattrs, which is made where there is none.
void list_label_image(const std::filesystem::path& target);

/// Equal for imports that give equal projects: what the source is (the names, sizes and times of its files as well) and
/// what is done to it.
std::string import_identity(const VolumeSource& source, const std::filesystem::path& origin,
                            const ImportOptions& options);

}  // namespace shvr
