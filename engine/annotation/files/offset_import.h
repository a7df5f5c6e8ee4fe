#pragma once
// Density offsets in whatever form they come. Those that say themselves how large they are must be of this volume; of bare
// numbers only their count tells. Any thread may call these.
//
//   .nrrd .tif and the others    volumes of one offset a voxel, of any type, as the readers of engine/volume know them
//   anything else                the thesis's bare numbers (offset_file.h)

#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/trace/trace_file.h"

namespace shvr {

/// The offsets for a volume of `type`; what `export_offsets` writes comes back bit for bit. Fails where the file is of another
/// size or, where it states one, spacing (of which both are named), where an offset is not finite or beyond `offset_limit`,
/// and where one for a volume of integers is none.
DensityField import_offsets(const std::filesystem::path& path, const TraceSpace& space, VoxelType type);

/// Saves in the form that the path names: as bare numbers where it is none that `export_offsets` knows. Fails where it is a
/// form that can be read and not written.
void save_offsets_as(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume);

}  // namespace shvr
