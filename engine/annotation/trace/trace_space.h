#pragma once
// The volume that an annotation belongs to, and its place in space. Any thread may call these.
//
// Traces are stored in volume space: voxel * spacing, measured from the outer corner of voxel 0. Other programs show
// volumes and annotation in physical space: the centre of voxel 0 is at `origin`, and the volume's axes run along the
// columns of `directions`, so physical = origin + directions * (position - spacing / 2). If a file states no place, the
// defaults of other programs apply: origin 0, and axes along those of physical space.

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

/// The space in which the positions of a file are stated.
enum class Positions { volume, physical };

glm::dvec3 physical_of(const TraceSpace& space, const glm::dvec3& position);
/// The inverse of `physical_of`, up to the rounding errors of both functions.
glm::dvec3 position_of(const TraceSpace& space, const glm::dvec3& physical);

/// Returns a text like "origin 1 2 3, axes ..., of LPS; expected origin ...". Empty if both have the same place, up to
/// a twentieth of a voxel, or if either states no place.
std::string why_elsewhere(const TraceSpace& found, const TraceSpace& expected);

/// Describes the space of a file's positions, for a comment in the file. The text has no line end.
std::string in_words(const TraceSpace& space, Positions positions);
/// Facts about the space that the reader of a file needs, as pairs of name and value such as "space" and "physical".
std::vector<std::pair<const char*, std::string>> statements_of(const TraceSpace& space, Positions positions);

}  // namespace shvr
