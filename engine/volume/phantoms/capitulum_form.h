#pragma once
// Forms of flower heads: species and stages of the thesis (5.2, figures 5.3 and 5.4), as parameters. Lengths are in
// radii of the head, heights above the middle of the volume, rho the distance from the axis. Pure functions.

#include <algorithm>
#include <string>
#include <vector>

#include "engine/volume/phantoms/phantom.h"

namespace shvr {

/// Sections of Gerbera hybrida, which are colour groups (thesis 5.2).
inline constexpr uint8_t ABAXIAL = 1, ADAXIAL = 2, FLORET = 3;

enum class AdaxialPattern { straight, joined, net };

struct CapitulumSpecies {
    const char* name;
    AdaxialPattern pattern;
    int spokes;            ///< adaxial veins; of a net none
    double rim, dome;      ///< height of the receptacle's edge, and of its middle above it
    double adaxial_inner;  ///< where adaxial veins end inwards
    double depth, droop;   ///< of adaxial veins below the receptacle: at the edge, and more per radius inwards
};

/// A flat, a depressed and an elongated sphere.
inline constexpr CapitulumSpecies CAPITULUM_SPECIES[] = {
    {"gerbera", AdaxialPattern::straight, 12, 0.15, 0.12, 0.28, 0.10, 0.0},
    {"helianthus", AdaxialPattern::joined, 16, 0.15, -0.18, 0.06, 0.06, 0.28},
    {"bellis", AdaxialPattern::net, 0, -0.05, 0.75, 0.08, 0.10, 0.0},
};

/// What is there at a stage, as rho. Veins of florets exist outside `florets_from`.
struct CapitulumStage {
    char name;
    double adaxial_from, adaxial_to;  ///< empty if equal; `adaxial_from` never inside of the species' inner end
    double florets_from;
    bool joins_rim;  ///< florets of the rim with abaxial veins
    /// The others with adaxial veins, or near the axis with each other; and adaxial with abaxial veins.
    bool joins_between;
};
inline constexpr CapitulumStage CAPITULUM_STAGES[] = {
    {'a', 0.0, 0.0, 2.0, false, false},
    {'b', 0.44, 0.60, 0.84, false, false},
    {'c', 0.28, 0.80, 0.55, true, false},
    {'d', 0.0, 0.84, 0.0, true, true},
};

/// Outside it, florets join abaxial veins.
inline constexpr double RIM_FROM = 0.86;

/// Heights of the receptacle's surface, of abaxial veins in the bowl below it, and of adaxial veins between the two.
inline double receptacle_height(const CapitulumSpecies& species, double rho)
{
    return species.rim + species.dome * (1.0 - rho * rho);
}
inline double abaxial_height(const CapitulumSpecies& species, double rho)
{
    return species.rim - 0.16 - 0.45 * (1.0 - rho * rho);
}
inline double adaxial_height(const CapitulumSpecies& species, double rho)
{
    return receptacle_height(species, rho) - species.depth - species.droop * (1.0 - rho);
}

struct FloretPlace {
    double turns, rho;
};
/// Floret k of n, from the axis outwards (Vogel 1979: equal areas): angles of successive florets, or pairs of opposite
/// ones of a bijugate head, differ by the divergence angle.
FloretPlace floret_place(const PhantomSpec& spec, int k);
/// Differences of numbers of florets that may be neighbours on a parastichy, ascending.
std::vector<int> parastichy_steps(const PhantomSpec& spec);

}  // namespace shvr
