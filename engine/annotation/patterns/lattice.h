#pragma once
// The lattice of a head's florets. On a cylinder whose coordinates are the azimuth and the rank by distance from the
// axis, the florets of a spiral pattern form a lattice: neighbours differ by a number of steps s, and in azimuth by s d
// modulo 2 pi, where d is the divergence angle. With jugacy g, florets come in whorls of g, steps count whorls, and
// azimuths are modulo 2 pi / g. Any thread may call these.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

inline constexpr double TURN = 6.283185307179586;

/// A floret and its nearest neighbour further from the axis on one side.
struct FloretPair {
    uint32_t inner, outer;
    double azimuth;  ///< radians from `inner` to `outer`, -pi ... pi
    double order;    ///< difference of the ranks by distance from the axis
    double length, rho;
    int step = 0;             ///< whorls from one to the other
    double chance = 0.0;      ///< probability that a pair of random azimuth would be in line
    bool is_in_line = false;  ///< a lattice point is at most `length` / 5 from `outer`
};

struct FloretLattice {
    int jugacy = 1;
    double divergence = 0.0;  ///< radians from a whorl to the next one outwards, 0 ... 2 pi / jugacy
    double share = 0.0;       ///< share of the pairs that agree with the lattice and each other
    std::vector<FloretPair> pairs{};
    /// Number of each floret's whorl, up to a common constant; null if the pairs do not determine it. Florets are
    /// sorted by their places, and florets at the same place count as one.
    std::vector<std::optional<int>> whorls{};
    glm::dvec2 centre{0.0};                              ///< fitted, relative to the axis
    double divergence_low = 0.0, divergence_high = 0.0;  ///< 95 % interval, by bootstrap over florets
    double square = 0.0, fourth = 0.0;                   ///< whorls = constant + square rho^2 + fourth rho^4

    /// Whorls per distance from the axis.
    double density(double rho) const { return rho * (2.0 * square + 4.0 * fourth * rho * rho); }
    /// Azimuth between whorls that are `step` apart, -pi / jugacy ... pi / jugacy.
    double azimuth_of(int step) const;
};
struct FoundLattice {
    std::optional<FloretLattice> lattice{};
    std::string reason{};
};
/// `places`: in the frame of the head, in head radii. Van Iterson's relation gives the first estimates: if A and B are
/// the mean vectors to the neighbours on both sides, in azimuth (a) and order (o), the numbers of parastichies are m =
/// 2 pi A_o / D and n = 2 pi B_o / D with D = A_a B_o - B_a A_o, even if florets are missing; m and n give the
/// divergence. Least squares refine each estimate and its centre. The result is the estimate with which most pairs
/// agree, and at whose lattice points most florets lie. Takes O(n log n) time.
FoundLattice find_lattice(const std::vector<glm::dvec3>& places);

/// Steps of the two visible families of parastichies at the distance `rho` from the axis: the shortest lattice vectors
/// to both sides. `stretch`: length along the receptacle per distance from the axis. Null if there is no lattice.
struct Parastichies {
    int left, right;  ///< steps; times the jugacy, these are the numbers of parastichies
};
std::optional<Parastichies> parastichies_at(const FloretLattice& lattice, double rho, double stretch);

}  // namespace shvr
