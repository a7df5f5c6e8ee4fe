#pragma once
// Distinguishes annotation from scans, by the
// content that a file states or by its
// voxels.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/volume/source.h"

namespace shvr {

enum class StatedContent { mask, offsets };

/// Returns `mask` for an OME-Zarr label image, a 3D Slicer segmentation or a mask exported as NRRD or TIFF; `offsets`
/// for offsets exported as NRRD or TIFF. Null if the file cannot be read or does not state its content, like TIFFs of
/// other programs.
std::optional<StatedContent> stated_content(const std::filesystem::path& path);

/// Returns "its voxels have the values 0 to 3 only" if the volume looks like a label image that a mask can hold: at
/// most 64 different values, all whole numbers from 0 to 255, and few labelled neighbours that differ. Otherwise empty.
/// Reads voxels only if the statistics allow a label image, and stops at the 65th value; volumes too large to read
/// whole are sampled.
std::string labels_in_words(const VolumeSource& source, const VolumeStatistics& statistics);

}  // namespace shvr
