#pragma once
// Sets the orientation of a volume's axes in a scanner's coordinate frame, and reorders voxels to make the axes
// right-handed. Any thread may call these.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Sets `directions`, `origin` and `frame` of `info`. Warns if the axes are rotated against the frame's axes or not
/// orthogonal, since the volume is drawn along its own axes all the same. `steps`: the columns are the vectors from
/// voxel to voxel along x, y and z, finite and not 0. `origin`: the centre of voxel 0. `frame`: right-handed, "RAS",
/// "LPS", or "" if it has no name. Axes that lie in one plane are ignored, with a warning. Returns the spacing, the
/// length of the steps.
glm::dvec3 place(VolumeInfo& info, const glm::dmat3& steps, const glm::dvec3& origin, const std::string& frame);

/// Returns `source` or, if its axes are left-handed, a source that reverses the order of voxels along one axis, with a
/// warning. That axis is the last one that points against the nearest axis of the frame, or z if none does. `source`
/// must have one level.
std::unique_ptr<VolumeSource> right_handed(std::unique_ptr<VolumeSource> source);

}  // namespace shvr
