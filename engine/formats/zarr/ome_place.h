#pragma once
// Where an image lies, in the attributes of an OME-Zarr. Any thread may call these.
//
// OME-Zarr 0.4 knows scales and translations, no directions. So the translation is along the image's own axes: the
// centre of voxel 0 in the frame that is turned as the volume is (for a volume that is not turned: its origin). An
// image that was cut out of another one, or made coarser, so lies on it, whatever way the axes run. The whole placement
// is in the attribute "shvr_placement": {"frame": "LPS", "directions": [[x of x, y of x, z of x], ...], "origin": [x,
// y, z]}, in the unit of the axes; it is only there if the volume's file stated one.

#include "engine/base/json.h"
#include "engine/volume/volume.h"

namespace shvr {

inline constexpr const char* OME_PLACEMENT = "shvr_placement";

/// The centre of voxel 0 along the volume's own axes, in its unit.
glm::dvec3 ome_translation(const VolumeInfo& info);

/// Sets `directions`, `origin` and `frame` of `info` from the attributes of an image that states `translation`. Where
/// the two disagree, the translation is believed, since other programs know it; a placement that is none is left out,
/// with a warning.
void read_ome_place(const JsonNode& attributes, const std::optional<glm::dvec3>& translation, VolumeInfo& info);

}  // namespace shvr
