#pragma once
// The order in which a simulated annotator works through the ground-truth graph. Follows the study's instruction to
// annotate bundles, starting with those joined to adaxial veins. A pure function; any thread.

#include <vector>

#include "engine/study/hand.h"
#include "engine/study/scene.h"

namespace shvr {

struct PlannedSegment {
    size_t segment = 0;           ///< of StudyScene::segments()
    std::vector<uint32_t> nodes;  ///< nodes of the true trace, in the order of work
    bool is_adaxial = false;
};
/// The plan begins at an end of an adaxial vein. Each further segment begins at a node that an earlier segment has
/// reached: the nearest first, and adaxial veins before others, with some randomness.
std::vector<PlannedSegment> plan_segments(const StudyScene& scene, StudyRandom& random);

/// Returns positions along a polyline, about `spacing` apart and equally far from each other, both ends included.
std::vector<glm::dvec3> points_along(std::span<const glm::dvec3> course, double spacing);
/// The axis of a planned segment, voxels.
std::vector<glm::dvec3> course_of(const StudyScene& scene, const PlannedSegment& planned);

}  // namespace shvr
