#pragma once
// The axis of a flower head as a line, fitted to its abaxial veins. Any thread may call these.
//
// All lengths are in scaled coordinates: the mean of the sections' nodes is 0, and their root mean square distance from
// it is 1.

#include <optional>
#include <utility>
#include <vector>

#include "engine/annotation/patterns/axes.h"
#include "engine/annotation/patterns/vein_graph.h"

namespace shvr {

struct HeadAxis {
    glm::dvec3 direction, centre;
};

/// A point of a vein, and the length of the part of the vein that it represents.
struct VeinPoint {
    glm::dvec3 at;
    double length;
};
/// The points of one abaxial vein, between its ends or branches.
using VeinCourse = std::vector<VeinPoint>;
/// Returns the courses of all abaxial veins; `scaled` holds each node's position in scaled coordinates.
std::vector<VeinCourse> abaxial_courses(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled);

/// Returns unit vectors x and y that make (x, y, direction) right-handed and orthonormal.
std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& direction);

/// Fits the axis: each abaxial vein should run in a plane through it. The axis is the line with the least sum of log(1
/// + (d / 0.05)^2), weighted by length; d is the distance of a vein's point from the vein's plane. In a flat head, the
/// veins hardly determine the direction, since they lie in planes through any line within the head, so tracing errors
/// would decide it. Therefore the direction is drawn towards the sections' axis of symmetry, in proportion to the
/// squares of these errors, and axes with veins and sections on two sides only are penalized. `moments`: of the
/// sections. Null if no veins lie around an axis.
std::optional<HeadAxis> axis_of_veins(const std::vector<VeinCourse>& courses, const Moments& moments);

}  // namespace shvr
