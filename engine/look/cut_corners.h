#pragma once
// Corners of what cutting planes leave of a volume. Pure; any thread.

#include <optional>
#include <utility>
#include <vector>

#include "engine/look/settings.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Returns the corners of the part of a box in which dot(plane.xyz, p) + plane.w is at most 0; none if that is empty.
std::vector<glm::dvec3> corners_left(const glm::dvec3& lower, const glm::dvec3& upper, const glm::dvec4& plane);
/// Returns the corners, in voxels, of what a cut leaves of the volume; none if it leaves nothing.
std::vector<glm::dvec3> corners_left(const CutBox& cut, const VolumeInfo& volume);
/// Returns the lower and upper corner, in voxels, of the smallest box around what a cut leaves; null: nothing.
std::optional<std::pair<glm::dvec3, glm::dvec3>> box_left(const CutBox& cut, const VolumeInfo& volume);

}  // namespace shvr
