#pragma once
// The small files of a project that an import writes, and the identity of an import. For import_volume.cpp.

#include <string>

#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/import_volume.h"
#include "engine/projects/levels/import_pyramid.h"

namespace shvr {

/// The array of a level, as it will be written. Only OME-Zarr 0.5 `has_shards`, and only for levels of several chunks:
/// up to 8 x 8 x 8 chunks in a file, with an index of their positions at the end.
ZarrVolume import_level(const std::filesystem::path& project, const VolumeInfo& info, int level, OmeZarrVersion version,
                        const ZarrCompressor& compressor, bool has_shards, const FillVoxel& fill = {});

/// The attributes of the image, as JSON: the content of .zattrs, or "attributes" of zarr.json. `labels`: additional
/// attributes of a label image, or null. `folder`: that of the levels within the image, empty or ending with a slash.
std::string import_attributes(OmeZarrVersion version, const std::string& name, const VolumeInfo& info, int levels,
                              Halving how, const LabelImage* labels, const std::string& folder = {});
/// The attributes of an image of numbers that belong to a volume: those of a project, and "shvr": {"shvr_KIND": 1}.
std::string number_attributes(const std::string& name, const VolumeInfo& info, const std::string& kind,
                              const std::string& folder);
/// The files of a group with these attributes, name and content: .zgroup and .zattrs, or zarr.json.
std::vector<std::pair<std::string, std::string>> group_files(OmeZarrVersion version, const std::string& attributes);
/// PROJECT/shvr/session.json.
std::string import_session();

/// Returns `folder` without "." and "..". Fails if it exists and is not a replaceable label image, or if it belongs to
/// an image's labels and that image's list of labels cannot be read. Creates the parent folder.
std::filesystem::path label_image_target(const std::filesystem::path& folder);
/// `folder` without dots. Fails if it exists and is no image of numbers of that kind (`number_attributes`).
std::filesystem::path number_image_target(const std::filesystem::path& folder, const std::string& kind);
/// Whether it is IMAGE/labels/NAME of an OME-Zarr image.
bool belongs_to_image(const std::filesystem::path& target);
/// The version of the image that `target` belongs to, which must be the same in a hierarchy; else `wanted`; else that
/// of the existing label image; else 0.4. Fails if `wanted` is not that of the image.
OmeZarrVersion label_image_version(const std::filesystem::path& target, std::optional<OmeZarrVersion> wanted);
/// Adds the label image to the list in IMAGE/labels, a group that is created if it is missing.
void list_label_image(const std::filesystem::path& target, OmeZarrVersion version);

/// Equal for imports that give equal projects: covers the source (including the names, sizes and times of its files)
/// and the processing applied to it. `way`: how the voxels are gone through, on which the state depends.
std::string import_identity(const VolumeSource& source, const std::filesystem::path& origin,
                            const ImportOptions& options, const char* way);

}  // namespace shvr
