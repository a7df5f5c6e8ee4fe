#pragma once
// Steps of find_lattice (lattice.h) once the steps of pairs are known.

#include "engine/annotation/patterns/lattice.h"

namespace shvr {

/// Numbers whorls along pairs in line, those with the smallest errors first, and sets the share of all pairs that agree
/// with the numbers.
void number_whorls(size_t florets, FloretLattice& lattice);

/// Least squares of divergence, phase and centre over the florets with numbers, weighted by rho^2 so that errors are
/// lengths; the interval of the divergence, by bootstrap; and the density of whorls.
void fit_lattice(const std::vector<glm::dvec3>& places, FloretLattice& lattice);

}  // namespace shvr
