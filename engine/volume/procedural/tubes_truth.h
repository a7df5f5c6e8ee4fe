#pragma once
// The truth of tubes along lines of straight pieces, some of which branch off others.

#include <optional>
#include <vector>

#include "engine/volume/procedural/source_procedural.h"

namespace shvr {

struct TubeStrand {
    std::vector<glm::dvec3> points{};  ///< voxel coordinates; may lie outside the volume
    double radius = 1.0;               ///< voxels
    std::optional<size_t> parent{};    ///< an earlier strand near whose axis it begins; each has one branch at most
};

/// Colour group 1, those with a parent 2. The graph lies in the groups to the last voxel: it has the parts of the lines
/// along which the tube's balls lie in the volume; a node on the parent's axis is joined to the first of the branch,
/// which is at most as thick as fits into the parent there.
ProceduralTruth truth_of_tubes(const std::vector<TubeStrand>& strands, const Size3& size);

}  // namespace shvr
