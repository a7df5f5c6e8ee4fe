#pragma once
// Checks whether a file of masks or offsets belongs to the annotated volume. Any thread may call these.

#include <filesystem>

#include "engine/annotation/trace/trace_file.h"

namespace shvr {

/// Whether the file or folder has a format that states its size: OME-Zarr folders and archives, NRRD, MHD, NIfTI and
/// TIFF. Files of raw bytes do not state it.
bool states_its_size(const std::filesystem::path& path);
/// Whether the path is an OME-Zarr archive or a path inside one. Masks in archives are read, but never written.
bool is_in_archive(const std::filesystem::path& path);

/// Fails, naming both values, if `found` differs in size or in a spacing or place that both state. `what`: "a mask".
void check_place(const std::filesystem::path& path, const char* what, const VolumeInfo& found, const TraceSpace& space);

/// Describes a volume of annotation ("mask" or "offsets") at the same place as the annotated volume.
VolumeInfo info_beside(const VolumeInfo& volume, const char* name, VoxelType type);

}  // namespace shvr
