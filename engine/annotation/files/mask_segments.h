#pragma once
// A mask as a segmentation of 3D Slicer (.seg.nrrd): names, colours and extents of its segments, which are groups.

#include <filesystem>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/formats/nrrd_head.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// The key/value pairs to set in the NRRD file at `path`, which is or will be a segmentation, when this mask replaces
/// its voxels: segments keep their numbers and all other keys; groups without a segment get one. Empty if neither the
/// name ends in .seg.nrrd nor the present file has segments. `looks`: names and colours of groups.
std::vector<NrrdPair> segment_pairs(const std::filesystem::path& path, const Mask& mask,
                                    const std::vector<LabelImage::Color>& looks);

}  // namespace shvr
