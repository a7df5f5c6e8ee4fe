#pragma once
// The transfer function as an exact piecewise-linear function, without a table.

#include <span>

#include "tests/reference/scene.h"

namespace shvr::reference {

/// One linear stretch; RGB and opacity at both ends.
struct TransferPiece {
    double x0 = 0.0, x1 = 0.0;
    glm::dvec4 value0{0.0}, value1{0.0};
    bool is_empty() const { return value0.a == 0.0 && value1.a == 0.0; }
    /// Densities outside [x0, x1] are clamped to it.
    glm::dvec4 at(double density) const;
};

class Transfer {
public:
    explicit Transfer(std::vector<ControlPoint> points);

    /// The stretch that holds at this density (right-continuous); an empty one outside.
    TransferPiece piece_at(double density) const;
    glm::dvec4 at(double density) const { return piece_at(density).at(density); }

    /// The boundaries of the pieces: ascending, each once; empty if nothing is drawn.
    std::span<const double> knots() const { return knots_; }
    /// The knot closer than 1e-14, or the density itself: undoes the rounding of a root.
    double snapped(double density) const;

private:
    std::vector<ControlPoint> points_;
    std::vector<double> knots_;
};

/// Opacity of a stretch `length` reference voxels long, 1 - (1 - opacity)^length. 0 and 1 are exact.
double opacity_of_length(double opacity, double length);

}  // namespace shvr::reference
