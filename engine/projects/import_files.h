#pragma once
// Makes a project's small files (metadata, attributes) and the text that identifies an import. For import_volume.cpp.

#include <string>

#include "engine/formats/zarr/zarr_volume.h"
#include "engine/projects/import_volume.h"
#include "engine/projects/levels/import_pyramid.h"

namespace shvr {

/// Returns the array of a level, as it will be written. `has_shards` requires OME-Zarr 0.5, and applies only to levels
/// of several chunks: a file then has up to 8 x 8 x 8 chunks, with an index of their positions at its end.
ZarrVolume import_level(const std::filesystem::path& project, const VolumeInfo& info, int level, OmeZarrVersion version,
                        const ZarrCompressor& compressor, bool has_shards, const FillVoxel& fill = {});

/// Returns the attributes of the image as JSON: the content of .zattrs, or "attributes" of zarr.json. `labels`: adds
/// attributes of a label image; may be null. `folder`: the levels' folder in the image; empty or ending in "/".
std::string import_attributes(OmeZarrVersion version, const std::string& name, const VolumeInfo& info, int levels,
                              Halving how, const LabelImage* labels, const std::string& folder = {});
/// Returns the attributes of an image of numbers: those of a project's image, and "shvr": {"shvr_KIND": 1}.
std::string number_attributes(const std::string& name, const VolumeInfo& info, const std::string& kind,
                              const std::string& folder);
/// Returns the files of a group with these attributes, as names with contents: .zgroup and .zattrs, or zarr.json.
std::vector<std::pair<std::string, std::string>> group_files(OmeZarrVersion version, const std::string& attributes);
/// Returns the content of PROJECT/shvr/session.json.
std::string import_session();

/// Returns `folder` without "." and "..", and creates its parent folder. Fails if `folder` exists and is not a
/// replaceable label image, or if it is in an image's folder `labels` whose list of labels cannot be read.
std::filesystem::path label_image_target(const std::filesystem::path& folder, bool replaces_any = false);
/// Returns `folder` without "." and "..". Fails if it exists and is not an image of numbers of this kind.
std::filesystem::path number_image_target(const std::filesystem::path& folder, const std::string& kind,
                                          bool replaces_any = false);
/// Whether `target` is IMAGE/labels/NAME of an OME-Zarr image.
bool belongs_to_image(const std::filesystem::path& target);
/// Returns the version for a label image: that of the image to which it belongs, else `wanted`, else that of the
/// existing label image, else 0.4. Fails if `wanted` differs from the image's, since a hierarchy has one version.
OmeZarrVersion label_image_version(const std::filesystem::path& target, std::optional<OmeZarrVersion> wanted);
/// Adds the label image to the list in IMAGE/labels; creates that group if it is missing.
void list_label_image(const std::filesystem::path& target, OmeZarrVersion version);

/// Returns a text that is equal for imports with equal results: the source (with names, sizes and times of its files),
/// the processing, and `way`: how the pass visits the voxels, on which the saved state depends. A volume on another
/// machine may change unnoticed: its identity is new each time, so that nothing is resumed, unless it `is_split`.
std::string import_identity(const VolumeSource& source, const std::filesystem::path& origin,
                            const ImportOptions& options, const char* way, bool is_split);

}  // namespace shvr
