#pragma once
// Whether a volume that a person's work is kept in, a mask or offsets, is of the volume that is worked on. Any thread may
// call these.

#include <filesystem>

#include "engine/annotation/trace/trace_file.h"

namespace shvr {

/// Whether the file or folder says itself how large it is, in a form that engine/volume reads: OME-Zarr folders, NRRD, MHD,
/// NIfTI and TIFF. Bare bytes do not.
bool states_its_size(const std::filesystem::path& path);

/// Fails, naming both, where `found` is of another size or, where it states one, spacing. `what`: "a mask".
void check_place(const std::filesystem::path& path, const char* what, const VolumeInfo& found, const TraceSpace& space);

}  // namespace shvr
