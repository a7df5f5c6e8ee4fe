#pragma once
// Traces are kept in volume space, voxel * spacing. Where a spacing is corrected, a node stays at its voxel and a
// radius keeps its voxels along x, so that lengths follow. Equal values stay equal: records that fitted one another fit
// one another afterwards. Any thread.

#include <string>

#include <glm/glm.hpp>

#include "engine/annotation/work/change.h"

namespace shvr {

/// Of the voxels that positions in a journal are in.
struct JournalSpace {
    glm::dvec3 spacing{1.0};  ///< each above 0
    std::string unit = "voxel";
    bool operator==(const JournalSpace&) const = default;
};
/// "0.5 0.5 2 um"
std::string in_words(const JournalSpace& space);

/// Up to what rounding and texts of nine digits make of a spacing.
bool is_same_spacing(const glm::dvec3& one, const glm::dvec3& other);
/// Position / from * to, and radius / from.x * to.x; changes of other kinds stay as they are.
void respace(Change& change, const glm::dvec3& from, const glm::dvec3& to);

}  // namespace shvr
