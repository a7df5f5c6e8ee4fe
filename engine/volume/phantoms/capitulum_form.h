#pragma once
// Shapes of flower heads: species and stages of the thesis (5.2, figures 5.3 and 5.4), as parameters. Unit of length:
// radius of the head. Heights are above the volume's middle. rho is the distance from the axis. Pure functions.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "engine/volume/phantoms/phantom.h"

namespace shvr {

/// Colour groups of the sections of Gerbera hybrida (thesis 5.2).
inline constexpr uint8_t ABAXIAL = 1, ADAXIAL = 2, FLORET = 3;

enum class AdaxialPattern { straight, joined, net };

struct CapitulumSpecies {
    const char* name;
    AdaxialPattern pattern;
    int spokes;            ///< number of adaxial veins; 0 for the pattern `net`
    double rim, dome;      ///< height of the receptacle's edge; height of its middle above its edge
    double adaxial_inner;  ///< rho at the inner end of adaxial veins
    double depth, droop;   ///< depth of adaxial veins below the receptacle's edge; its increase per unit of rho inwards
};

/// Species whose heads are a flat, a depressed and an elongated sphere, in this order.
inline constexpr CapitulumSpecies CAPITULUM_SPECIES[] = {
    {"gerbera", AdaxialPattern::straight, 12, 0.15, 0.12, 0.28, 0.10, 0.0},
    {"helianthus", AdaxialPattern::joined, 16, 0.15, -0.18, 0.06, 0.06, 0.28},
    {"bellis", AdaxialPattern::net, 0, -0.05, 0.75, 0.08, 0.10, 0.0},
};

/// The parts that exist at a stage of development. Numbers are values of rho; florets have veins beyond `florets_from`.
struct CapitulumStage {
    char name;
    double adaxial_from, adaxial_to;  ///< equal: no adaxial veins; `adaxial_from` >= the species' `adaxial_inner`
    double florets_from;
    bool joins_rim;  ///< joins florets' veins at the rim to abaxial veins
    /// Joins other florets' veins to adaxial veins or, near the axis, to each other; and adaxial to abaxial veins.
    bool joins_between;
    /// Middle and tip of bracts: rho, height above the rim. Bracts first cover the head, and spread at later stages.
    std::array<glm::dvec2, 2> bract;
};
inline constexpr CapitulumStage CAPITULUM_STAGES[] = {
    {'a', 0.0, 0.0, 2.0, false, false, {{{1.03, 0.12}, {0.90, 0.36}}}},
    {'b', 0.44, 0.60, 0.84, false, false, {{{1.05, 0.08}, {1.06, 0.32}}}},
    {'c', 0.28, 0.80, 0.55, true, false, {{{1.06, 0.05}, {1.12, 0.26}}}},
    {'d', 0.0, 0.84, 0.0, true, true, {{{1.07, 0.03}, {1.17, 0.16}}}},
};

/// Outside it, florets join abaxial veins.
inline constexpr double RIM_FROM = 0.86;

/// Heights of the receptacle's surface, of abaxial veins in the bowl, and of adaxial veins between these two.
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

/// Returns the angle between successive florets, or for "bijugate" between successive pairs of florets, in turns.
double divergence_turns(const PhantomSpec& spec);
struct FloretPlace {
    double turns, rho;
};
/// Returns the place of floret k of n, counted from the axis outwards, such that each has an equal area (Vogel 1979).
/// Successive florets, or in a bijugate head successive pairs of opposite florets, differ by the divergence angle.
FloretPlace floret_place(const PhantomSpec& spec, int k);
/// Returns, in ascending order, the possible differences between the numbers of neighbouring florets on a parastichy.
std::vector<int> parastichy_steps(const PhantomSpec& spec);

}  // namespace shvr
