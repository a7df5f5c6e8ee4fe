#pragma once
// The volume that annotation belongs to, and its position in space. Any thread may call these.
//
// Volume space, in which traces are stored: voxel * spacing, from the outer corner of voxel 0. Physical space, in which
// other programs show volumes and annotation: the centre of voxel 0 is at `origin`, and the axes run along the columns
// of `directions`. So physical = origin + directions * (position - spacing / 2). If no place is stated, the defaults
// are those of other programs: origin 0, axes along those of space.

#include <string>
#include <utility>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

struct TraceSpace {
    Size3 size{0};
    glm::dvec3 spacing{1.0};
    std::string unit = "voxel";
    glm::dmat3 directions{1.0};
    glm::dvec3 origin{0.0};
    std::string frame{};  ///< "RAS", "LPS", or "" for a frame without a name
    bool operator==(const TraceSpace&) const = default;
};
TraceSpace space_of(const VolumeInfo& volume);

/// The space that the positions of a file are in.
enum class Positions { volume, physical };

glm::dvec3 physical_of(const TraceSpace& space, const glm::dvec3& position);
/// The inverse of `physical_of`, up to the rounding errors of both functions.
glm::dvec3 position_of(const TraceSpace& space, const glm::dvec3& physical);

/// Returns a text like "origin 1 2 3, axes ..., of LPS; expected origin ...". Empty if both have the same place, up to
/// a twentieth of a voxel, or if one of them states no place.
std::string why_elsewhere(const TraceSpace& found, const TraceSpace& expected);

/// Describes the space of a file's positions, for a comment in the file; without a line end.
std::string in_words(const TraceSpace& space, Positions positions);
/// "space physical", "frame LPS", ...: the statements that a reader needs, as pairs of name and value.
std::vector<std::pair<const char*, std::string>> statements_of(const TraceSpace& space, Positions positions);

}  // namespace shvr
