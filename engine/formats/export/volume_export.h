#pragma once
// Exports a volume as one file that other programs read. Voxels are read and written strip by strip.
//
//   .nrrd        raw voxels after a header with spacing, unit and orientation; little-endian
//   .tif .tiff   one page per slice, deflated; spacing and unit as ImageJ writes them; BigTIFF if needed. Programs do
//                not agree on where a TIFF states its position: origin, directions and exact spacing are in lines of
//                ImageJ's description that only SHVR reads ("shvr_origin=1 2 3")
//
// Any thread may call these.

#include <filesystem>

#include "engine/formats/nrrd_head.h"
#include "engine/volume/source.h"

namespace shvr {

/// The key that distinguishes an exported mask or exported density offsets from a scan: "shvr_content:=mask" in NRRD,
/// and "shvr_content=mask" in the description of a TIFF.
inline constexpr const char* NRRD_CONTENT_KEY = "shvr_content";

bool is_volume_export(const std::filesystem::path& path);

/// Exports to `path` in the format of its extension, and atomically replaces an existing file. An NRRD file keeps the
/// comments, key/value pairs and fields of `kept` (if null: of the file it replaces), except fields about voxels and
/// axes. Fails for an unknown extension.
void export_volume(const std::filesystem::path& path, const VolumeSource& source, const Progress& progress = {},
                   const std::optional<NrrdHead>& kept = {});

/// Writers of one format each; for volume_export.cpp.
void export_nrrd(const std::filesystem::path& path, const VolumeSource& source, const NrrdHead& kept);
void export_tiff(const std::filesystem::path& path, const VolumeSource& source);

/// Returns the number of rows that an export reads at a time: as many rows of a slice as 256 KiB hold, at least one.
int64_t export_rows(const VolumeInfo& info);

}  // namespace shvr
