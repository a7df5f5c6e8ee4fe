#pragma once
// The axis of a flower head as a line, how certain it is, and the courses of abaxial veins. Any thread may call these.
//
// All lengths are in scaled coordinates, as in axis_fit.h.

#include <optional>
#include <vector>

#include "engine/annotation/patterns/axes.h"
#include "engine/annotation/patterns/axis_fit.h"
#include "engine/annotation/patterns/vein_graph.h"

namespace shvr {

/// A point of a vein, and the length of the part of the vein that it represents.
struct VeinPoint {
    glm::dvec3 at;
    double length;
};
/// The points of one abaxial vein, between its ends or branches.
using VeinCourse = std::vector<VeinPoint>;
/// Returns the courses of all abaxial veins; `scaled` holds each node's position in scaled coordinates.
std::vector<VeinCourse> abaxial_courses(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled);

struct FoundAxis {
    HeadAxis axis;
    /// The error is smaller than these in 99 of 100 traces: of the direction, in radians, and of the place.
    double turn = 0.0, shift = 0.0;
    bool is_ambiguous = false;  ///< another line, further away than these, fits nearly as well
};

/// Finds the axis as the line around which the head is symmetrical: each abaxial vein runs in a plane through it, and
/// the ends of the florets, the adaxial veins and the bowl of the abaxial veins lie on surfaces of revolution. Its
/// errors are the larger of two estimates: from the spread of the points, and from ten fits, each without a tenth of
/// the head (jackknife over pieces of azimuth), which also sees where the head itself is irregular. Null if no veins
/// lie around an axis.
std::optional<FoundAxis> axis_of_head(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled,
                                      const std::vector<VeinCourse>& courses, const Eigen& principal);

}  // namespace shvr
