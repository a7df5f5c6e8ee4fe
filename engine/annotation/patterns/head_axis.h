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

/// A point of a vein, and the length that it stands for.
struct VeinPoint {
    glm::dvec3 at;
    double length;
};
/// The points of one abaxial vein, between its ends or branches.
using VeinCourse = std::vector<VeinPoint>;
/// `scaled` gives a node's place in scaled coordinates.
std::vector<VeinCourse> abaxial_courses(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled);

/// Returns a unit vector across `direction`, and the third axis.
std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& direction);

/// Each abaxial vein runs in a plane through the axis. The axis is the line with the least sum of log(1 + (d /
/// 0.05)^2) by length, d the distance of a vein's point from the vein's plane. Where the veins hardly decide the
/// direction, as in a flat head, whose veins lie in planes through any line in it, errors of a trace would: so the
/// direction is drawn, by the square of these errors, to the sections' axis of symmetry, and axes around which veins
/// and sections lie to two sides only are the worse for it. `moments` are those of the sections. Null without veins
/// around an axis.
std::optional<HeadAxis> axis_of_veins(const std::vector<VeinCourse>& courses, const Moments& moments);

}  // namespace shvr
