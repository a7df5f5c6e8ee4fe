#pragma once
// Steps of find_lattice (lattice.h) once the steps of pairs are known.

#include "engine/annotation/patterns/lattice.h"

namespace shvr {

/// Numbers whorls along pairs in line, those with the smallest errors first, and sets the share of all pairs that agree
/// with the numbers.
void number_whorls(size_t florets, FloretLattice& lattice);

/// Least squares of divergence, phase and centre over the florets with numbers, weighted by rho^2 so that errors are
/// lengths, and of the density of whorls. Returns the share of all florets that then lie within 0.3 of the pairs'
/// median length of their place, around the axis and outwards.
double fit_lattice(const std::vector<glm::dvec3>& places, FloretLattice& lattice);
/// The interval of the divergence, by bootstrap.
void add_interval(const std::vector<glm::dvec3>& places, FloretLattice& lattice);

}  // namespace shvr
