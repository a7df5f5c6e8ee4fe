#pragma once
// Distinguishes annotation from scans by the metadata of a voxel file. Any thread may call it.

#include <filesystem>
#include <optional>

namespace shvr {

enum class StatedContent { mask, offsets };

/// Mask: an OME-Zarr label image, a segmentation of 3D Slicer, or a mask that was exported as NRRD; offsets: exported
/// as NRRD. Null if the file states nothing (as every TIFF) or cannot be read.
std::optional<StatedContent> stated_content(const std::filesystem::path& path);

}  // namespace shvr
