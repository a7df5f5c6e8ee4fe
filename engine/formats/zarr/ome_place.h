#pragma once
// The position of an image in the attributes of an OME-Zarr. Any thread may call these.
//
// OME-Zarr 0.4 supports scales and translations, but no directions. So the translation is written along the image's own
// axes: the centre of voxel 0 in a frame rotated like the volume (unrotated: its origin). An image that is cropped or
// downscaled from another thus overlays the original, whatever the axes' directions. The full placement is in the
// attribute "shvr_placement": {"frame": "LPS", "directions": [[x, y, z of the x axis], ...], "origin": [x, y, z]}, in
// the unit of the axes. The attribute is present only if the volume's file stated a placement.

#include "engine/base/json.h"
#include "engine/volume/volume.h"

namespace shvr {

inline constexpr const char* OME_PLACEMENT = "shvr_placement";

/// Returns the position of voxel 0's centre along the volume's own axes, in the volume's unit.
glm::dvec3 ome_translation(const VolumeInfo& info);

/// Sets `directions`, `origin` and `frame` of `info` from an image's attributes; `translation` is the one that the
/// image states. If the placement contradicts it, `translation` wins, since other programs use it. An invalid placement
/// is ignored with a warning.
void read_ome_place(const JsonNode& attributes, const std::optional<glm::dvec3>& translation, VolumeInfo& info);

}  // namespace shvr
