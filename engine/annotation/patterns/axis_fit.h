#pragma once
// Least squares for the axis of a flower head, from veins and surfaces around it. Any thread may call these.
//
// All lengths are in scaled coordinates: the mean of the sections' nodes is 0, and their root mean square distance from
// it is 1.

#include <utility>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

struct HeadAxis {
    glm::dvec3 direction, centre;
};

/// Returns unit vectors x and y that make (x, y, direction) right-handed and orthonormal.
std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& direction);

/// What the axis is fitted to. `of`: the piece of the head that each vein or point belongs to.
struct AxisData {
    struct Vein {
        std::vector<glm::dvec3> points;
        int of = 0;
    };
    struct Point {
        glm::dvec3 at;
        int of = 0;
    };
    std::vector<Vein> veins{};        ///< abaxial; each runs in a plane through the axis
    std::vector<Point> receptacle{};  ///< ends of florets: their height is an even polynomial of rho
    /// Nodes of adaxial and of abaxial veins: their height is a polynomial of rho. Abaxial nodes count where the bowl
    /// has left the stem.
    std::vector<Point> adaxial{}, bowl{};
};

struct AxisFit {
    HeadAxis axis;
    /// Minus the logarithm of the likelihood, up to a constant: comparable between fits to the same data.
    double cost = 0.0;
    /// Inverse of the covariance of (turn of the direction along x and y, shift of the centre along x and y).
    glm::dmat4 information{0.0};
};

/// Refines the axis by Gauss-Newton steps. The points' errors are estimated from the points themselves, of veins and of
/// each surface separately; Cauchy's weights make single wrong points count little. Leaves out the pieces of the head
/// `without`; -1 leaves out none. `steps`: at most.
AxisFit refined_axis(const AxisData& data, HeadAxis axis, int without = -1, int steps = 60);

}  // namespace shvr
