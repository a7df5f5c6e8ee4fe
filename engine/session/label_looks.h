#pragma once
// The looks of colour groups in the label image that a mask is kept in (OME-Zarr 0.4, image-label: colors and properties).
// Colours are sRGB of 8 bits a channel there, alpha the opacity; the tree of groups and what is hidden have no place in it.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/look/groups.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// Of the groups that are painted or set up, ascending.
std::vector<LabelImage::Color> label_looks(const Groups& groups, const Mask& mask);

/// Gives each group that `groups` does not define what the label image `mask` says of it, where that is another look than
/// it has anyway. Labels above 255 are no groups. Nothing where `mask` is no label image. Returns a sentence for each entry
/// that cannot be taken.
std::vector<std::string> take_label_looks(const std::filesystem::path& mask, Groups& groups);

}  // namespace shvr
