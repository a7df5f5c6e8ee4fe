#pragma once
// The looks of colour groups in the label image that a mask is kept in (OME-Zarr, image-label: colors and
// properties). Colours are sRGB of 8 bits a channel there, alpha the opacity; the format cannot hold the tree of groups
// nor which groups are hidden or locked.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/look/groups.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// The looks of all groups that are painted or defined, in ascending order.
std::vector<LabelImage::Color> label_looks(const Groups& groups, const Mask& mask);

/// Gives each group that `groups` does not define its look in the label image `mask`, if that differs from the default.
/// Labels above 255 are not groups. Does nothing if `mask` is not a label image. Returns a sentence for each list with
/// entries that are malformed.
std::vector<std::string> take_label_looks(const std::filesystem::path& mask, Groups& groups);

}  // namespace shvr
