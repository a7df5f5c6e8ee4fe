#pragma once
// Converts the looks of colour groups to and from the file that stores a mask: an OME-Zarr label image (image-label:
// colors and properties), or a segmentation of 3D Slicer (.seg.nrrd: names and colours of segments, without opacity).
// There, colours are sRGB of 8 bits per channel, and alpha is the opacity. Neither format can store the tree of groups
// or which groups are hidden or locked.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/look/groups.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// The looks of all groups that are painted or defined, in ascending order.
std::vector<LabelImage::Color> label_looks(const Groups& groups, const Mask& mask);

/// Takes the look of each group that `groups` does not define from the file `mask`, if that look differs from the
/// default. Labels above 255 are not groups. Does nothing if `mask` is neither a label image nor a segmentation.
/// Returns a warning for each list with malformed entries.
std::vector<std::string> take_label_looks(const std::filesystem::path& mask, Groups& groups);

}  // namespace shvr
