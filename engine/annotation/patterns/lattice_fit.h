#pragma once
// Later steps of find_lattice (lattice.h), in which the pairs' steps are known.

#include "engine/annotation/patterns/lattice.h"

namespace shvr {

/// Numbers the whorls along pairs in line, in order of growing error, and sets the share of all pairs that agree with
/// the numbers.
void number_whorls(size_t florets, FloretLattice& lattice);

/// Fits divergence, phase and centre to the numbered florets by least squares (weighted by rho^2, so that errors are
/// lengths), then the density of whorls. Returns the share of all florets that end up at most 0.3 median pair lengths
/// from their lattice points, both around the axis and outwards.
double fit_lattice(const std::vector<glm::dvec3>& places, FloretLattice& lattice);
/// The interval of the divergence, by bootstrap.
void add_interval(const std::vector<glm::dvec3>& places, FloretLattice& lattice);

}  // namespace shvr
