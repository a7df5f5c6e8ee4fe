#pragma once
// Distinguishes annotation from scans by the metadata of a voxel file. Any thread may call it.

#include <filesystem>
#include <optional>

namespace shvr {

enum class StatedContent { mask, offsets };

/// Returns mask for an OME-Zarr label image, a 3D Slicer segmentation or a mask exported as NRRD or TIFF; offsets for
/// offsets exported as NRRD or TIFF. Null if the file cannot be read or does not state its content, as TIFFs of other
/// programs.
std::optional<StatedContent> stated_content(const std::filesystem::path& path);

}  // namespace shvr
