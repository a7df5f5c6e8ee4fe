#pragma once
// Where the axes of a volume lie in the frame of a scanner, and how voxels are reordered to match. Any thread may call
// these.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Sets `directions`, `origin` and `frame` of `info`, and warns if the axes are rotated against the frame's or are not
/// at right angles: the volume is drawn along its own axes. `steps`: its columns lead from voxel to voxel along x, y
/// and z; finite and not 0. `origin`: the centre of voxel 0. `frame`: right-handed, "RAS", "LPS", or "" if it has no
/// name. Axes that lie in one plane are ignored, with a warning. Returns the spacing: the length of the steps.
glm::dvec3 place(VolumeInfo& info, const glm::dmat3& steps, const glm::dvec3& origin, const std::string& frame);

/// `source`, or, if its axes are left-handed, a source that reverses the order of its voxels along one of them, with a
/// warning. That is the last axis that runs against its nearest axis of the frame; z if none does. `source` must have
/// one level.
std::unique_ptr<VolumeSource> right_handed(std::unique_ptr<VolumeSource> source);

}  // namespace shvr
