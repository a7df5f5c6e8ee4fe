#pragma once
// Cubic polynomials on [0, 1] in Bernstein form, and where they cross a set of levels. A trilinear field along a
// straight line inside one cell is such a cubic.

#include <array>
#include <span>
#include <vector>

namespace shvr::reference {

struct Cubic {
    std::array<double, 4> bernstein{};
    /// de Casteljau; exactly constant where the four coefficients agree.
    double at(double t) const;
};

/// The cubic with these values at t = 0, 1/3, 2/3, 1; exactly constant where they agree.
Cubic cubic_through(const std::array<double, 4>& values);

/// Inner zeros of the derivative, ascending.
std::vector<double> turning_points(const Cubic& cubic);

/// Ascending t from 0 to 1, both included, that cut the cubic into stretches on which it is monotone and crosses none
/// of the levels (ascending). Roots are bisected until no double lies between their brackets.
std::vector<double> split_at_levels(const Cubic& cubic, std::span<const double> levels);

}  // namespace shvr::reference
