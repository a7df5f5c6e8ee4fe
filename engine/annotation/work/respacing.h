#pragma once
// Adapts traces to a corrected spacing. Traces are stored in volume space, voxel * spacing. If the spacing changes, a
// node stays at its voxel and a radius keeps its number of voxels along x, so lengths change accordingly. Equal values
// stay equal, so records that fitted each other before still do. Any thread.

#include <string>

#include <glm/glm.hpp>

#include "engine/annotation/work/change.h"

namespace shvr {

/// The voxel spacing in which a journal's positions are expressed.
struct JournalSpace {
    glm::dvec3 spacing{1.0};  ///< each above 0
    std::string unit = "voxel";
    bool operator==(const JournalSpace&) const = default;
};
/// "0.5 x 0.5 x 2 µm"
std::string in_words(const JournalSpace& space);

/// Whether two spacings are equal up to rounding, which includes rounding to nine digits in a text file.
bool is_same_spacing(const glm::dvec3& one, const glm::dvec3& other);
/// Converts a position to position / from * to, and a radius to radius / from.x * to.x; does not affect other changes.
void respace(Change& change, const glm::dvec3& from, const glm::dvec3& to);

}  // namespace shvr
