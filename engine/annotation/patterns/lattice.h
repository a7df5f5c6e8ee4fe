#pragma once
// The lattice of a head's florets. On the cylinder of azimuth and order from the axis outwards, florets of a spiral
// pattern lie on a lattice: neighbours differ by steps s, at azimuths s d modulo 2 pi, with the divergence angle d.
// With jugacy g, florets come in whorls of g, steps count whorls, and azimuths are modulo 2 pi / g.
// Any thread may call these.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

inline constexpr double TURN = 6.283185307179586;

/// A floret and a nearest one further out, to one side.
struct FloretPair {
    uint32_t inner, outer;
    double azimuth;  ///< radians from `inner` to `outer`, -pi ... pi
    double order;    ///< florets from one to the other, by distance from the axis
    double length, rho;
    int step = 0;             ///< whorls from one to the other
    double chance = 0.0;      ///< probability that a pair of random azimuth is in line
    bool is_in_line = false;  ///< the lattice has a floret within a fifth of the length of `outer`
};

struct FloretLattice {
    int jugacy = 1;
    double divergence = 0.0;  ///< radians from a whorl to the next further out, 0 ... 2 pi / jugacy
    double share = 0.0;       ///< pairs that agree with the lattice and each other
    std::vector<FloretPair> pairs{};
    /// The number of each floret's whorl, up to a common constant; null where pairs do not tell. Florets are in the
    /// order of their places; florets at one place count once.
    std::vector<std::optional<int>> whorls{};
    glm::dvec2 centre{0.0};                              ///< fitted, relative to the axis
    double divergence_low = 0.0, divergence_high = 0.0;  ///< 95 % interval, by bootstrap over florets
    double square = 0.0, fourth = 0.0;                   ///< whorls = constant + square rho^2 + fourth rho^4

    /// Whorls per distance from the axis.
    double density(double rho) const { return rho * (2.0 * square + 4.0 * fourth * rho * rho); }
    /// Azimuth of a step, -pi / jugacy ... pi / jugacy.
    double azimuth_of(int step) const;
};
struct FoundLattice {
    std::optional<FloretLattice> lattice{};
    std::string reason{};
};
/// `places` in the frame of the head, in its radii. The first estimate is van Iterson's relation: mean vectors A and B
/// from florets to their neighbours on both sides, in azimuth and order, give the numbers of parastichies m = 2 pi A_o
/// / D and n = 2 pi B_o / D with D = A_a B_o - B_a A_o, whatever share of the florets is missing, and m and n give the
/// divergence. Each estimate is refined by least squares, as is the centre; the one counts that most pairs agree with,
/// and whose places most florets lie in. Costs n log n.
FoundLattice find_lattice(const std::vector<glm::dvec3>& places);

/// Steps of the two visible families of parastichies at a distance from the axis: the shortest vectors of the lattice
/// to both sides. `stretch` is the receptacle's length per distance from the axis. Null without a lattice there.
struct Parastichies {
    int left, right;  ///< steps; numbers of parastichies are these times the jugacy
};
std::optional<Parastichies> parastichies_at(const FloretLattice& lattice, double rho, double stretch);

}  // namespace shvr
