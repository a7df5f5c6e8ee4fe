#pragma once
// The truth of tubes along polylines, some of which branch off others.

#include <optional>
#include <vector>

#include "engine/volume/procedural/source_procedural.h"

namespace shvr {

struct TubeStrand {
    std::vector<glm::dvec3> points{};  ///< voxel coordinates; may lie outside the volume
    double radius = 1.0;               ///< voxels
    std::optional<size_t> parent{};    ///< earlier strand near whose axis this begins; no strand has two branches
};

/// Strands have colour group 1, or 2 if they have a parent. The graph lies entirely in the voxels of its groups: it
/// covers those parts of the lines where the tube's balls lie in the volume. A node on the parent's axis is joined to
/// the branch's first node, whose radius is at most what fits into the parent there.
ProceduralTruth truth_of_tubes(const std::vector<TubeStrand>& strands, const Size3& size);

}  // namespace shvr
