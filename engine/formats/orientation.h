#pragma once
// The orientation of a volume's axes in a scanner's coordinate frame, and the reordering of voxels to make axes
// right-handed. Any thread may call these.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Sets `directions`, `origin` and `frame` of `info`, and warns if the axes are rotated relative to the frame's axes or
/// not orthogonal, since the volume is drawn along its own axes. `steps`: the columns are the vectors from voxel to
/// voxel along x, y and z, finite and not 0. `origin`: the centre of voxel 0. `frame`: right-handed, "RAS", "LPS", or
/// "" if it has no name. Axes that lie in one plane are ignored, with a warning. Returns the spacing, which is the
/// length of the steps.
glm::dvec3 place(VolumeInfo& info, const glm::dmat3& steps, const glm::dvec3& origin, const std::string& frame);

/// Returns `source` or, if its axes are left-handed, a source with the order of voxels reversed along one axis, with a
/// warning. The reversed axis is the last one that points against its nearest axis of the frame; z if none does.
/// `source` must have one level.
std::unique_ptr<VolumeSource> right_handed(std::unique_ptr<VolumeSource> source);

}  // namespace shvr
