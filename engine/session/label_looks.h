#pragma once
// Converts names and colours of groups to and from the file that stores a mask: an OME-Zarr label image (image-label:
// colors and properties) or a segmentation of 3D Slicer (.seg.nrrd: names and colours of segments, without opacity).
// Colours there are sRGB with 8 bits per channel; alpha is the opacity. Neither format can store parents of groups, or
// which groups are hidden or locked.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/look/groups.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// Returns the looks of all groups that are painted or defined, in ascending order of group.
std::vector<LabelImage::Color> label_looks(const Groups& groups, const Mask& mask);

/// Adds to `groups` the look of each group that it does not define, from the file `mask`, if that look differs from the
/// default. Labels above 255 are not groups. Does nothing if `mask` is neither a label image nor a segmentation.
/// Returns a warning for each list with malformed entries.
std::vector<std::string> take_label_looks(const std::filesystem::path& mask, Groups& groups);

}  // namespace shvr
