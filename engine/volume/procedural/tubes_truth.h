#pragma once
// The ground truth for tubes along polylines, some of which are branches of others.

#include <optional>
#include <vector>

#include "engine/volume/procedural/source_procedural.h"

namespace shvr {

struct TubeStrand {
    std::vector<glm::dvec3> points{};  ///< in voxel coordinates; may lie outside the volume
    double radius = 1.0;               ///< voxels
    std::optional<size_t> parent{};    ///< earlier strand of which this is a branch; at most one per parent
};

/// Strands have colour group 1, or 2 if they have a parent. The graph lies entirely inside the voxels of its groups,
/// since it covers only parts of the lines where the tube's balls lie inside the volume. A branch's first node is
/// joined to a node on the parent's axis, and its radius is at most what fits into the parent there.
ProceduralTruth truth_of_tubes(const std::vector<TubeStrand>& strands, const Size3& size);

}  // namespace shvr
