#pragma once
// The order in which an annotator works through the true graph. The instruction of the study: annotate bundles,
// starting with those that are joined to adaxial veins. Pure; any thread.

#include <vector>

#include "engine/study/hand.h"
#include "engine/study/scene.h"

namespace shvr {

struct PlannedSegment {
    size_t segment = 0;           ///< of StudyScene::segments()
    std::vector<uint32_t> nodes;  ///< nodes of the true trace, in the direction of work
    bool is_adaxial = false;
};
/// Begins at an end of an adaxial vein; each further segment begins where an earlier one ended or branched. Adaxial
/// veins come first among segments that are equally near, and straight continuations before branches.
std::vector<PlannedSegment> plan_segments(const StudyScene& scene, StudyRandom& random);

/// Positions along a chain of straight pieces, at equal distances of about `spacing`, both ends included.
std::vector<glm::dvec3> points_along(std::span<const glm::dvec3> course, double spacing);
/// The axis of a planned segment, voxels.
std::vector<glm::dvec3> course_of(const StudyScene& scene, const PlannedSegment& planned);

}  // namespace shvr
