#pragma once
// The codebook of pattern measures: the only list of their names. CODEBOOK.md repeats it; a test compares the two.

#include "engine/annotation/patterns/pattern_table.h"

namespace shvr {

inline constexpr PatternMeasure PATTERN_MEASURES[] = {
    {"head_radius", "LENGTH",
     "distance from the axis of the outermost floret; without florets, of the outermost node of a section. All rho are "
     "distances from the axis in this unit",
     "built-in value of a phantom"},
    {"axis_x", "LENGTH", "a point of the axis, in physical space, as exported traces are; likewise axis_y and axis_z",
     "the fit in head_frame.h; built-in value of a phantom"},
    {"axis_y", "LENGTH", "see axis_x", ""},
    {"axis_z", "LENGTH", "see axis_x", ""},
    {"axis_direction_x", "1", "unit vector along the axis from the stem to the florets; likewise _y and _z",
     "built-in value of a phantom"},
    {"axis_direction_y", "1", "see axis_direction_x", ""},
    {"axis_direction_z", "1", "see axis_direction_x", ""},
    {"axis_residual", "degree",
     "root mean square angle between chords of abaxial veins and planes through the axis, by length; chords are 0.3 "
     "times "
     "the sections' root mean square radius long, or a whole vein; large where the axis is uncertain",
     "veins in planes through an axis: 0"},
    {"axis_direction_error", "degree",
     "the axis's direction is less wrong than this in 99 of 100 traces: the larger of two estimates, from the spread "
     "of "
     "the points and from ten fits, each without a tenth of the head; where it is above 5, axis_place_error above "
     "0.05, "
     "or another axis fits nearly as well, measures that need the axis have a reason and no value",
     "exact traces 0", false},
    {"axis_place_error", "1",
     "the same of the axis's place, where it passes the mean of the sections' nodes, in head radii", "exact traces 0",
     false},
    {"covered_angle", "degree",
     "360 less the widest gap of azimuth between nodes of the sections, where rho > 0.3; measures of gaps between "
     "sectors and per area have a reason and no value below 270",
     "built-in value of a phantom"},
    {"vein_length_A", "LENGTH", "length of the veins of section A (abaxial, adaxial or floret), without connections",
     "sum", false},
    {"florets", "1",
     "ends of florets' veins that are higher along the axis than the other end of their segment, and nodes of the "
     "florets' section without internodes",
     "built-in number of a phantom", false},
    {"connections_A_B", "1",
     "internodes between nodes of sections A and B, and nodes at which veins of both meet without such an internode; "
     "floret_floret: internodes of florets' veins between the places nearest, along the veins, to two florets",
     "thesis, figure 5.3; planted numbers", false},
    {"connections_A_B_rho_least", "1", "least rho of these connections; of an internode at its middle", "planted"},
    {"connections_A_B_rho_median", "1", "median", "planted"},
    {"connections_A_B_rho_most", "1", "greatest", "planted"},
    {"connections_A_B_rho_FROM_to_TO", "1", "number of these connections with FROM <= rho < TO", "planted"},
    {"radiality", "1",
     "mean of the absolute cosine between adaxial internodes, projected to the receptacle's tangent plane, and the "
     "radial direction in it, weighted by their projected lengths; the plane across the axis where florets do not "
     "determine the receptacle",
     "spokes 1; circle 0; random directions 2/pi"},
    {"droop", "degree",
     "mean angle of adaxial veins, followed inwards, below the tangent plane of the receptacle at the same rho, "
     "weighted by length, where florets lie above; the receptacle is an even polynomial of rho through the florets",
     "parallel veins 0; a slope s of the depth under a flat receptacle: atan s"},
    {"sectors_rho_R", "1", "number of crossings of adaxial veins with the circle of rho R around the axis",
     "number of spokes"},
    {"sector_gap_mean_rho_R", "degree", "mean difference of azimuth of successive crossings", "360 / number"},
    {"sector_gap_cv_rho_R", "1", "standard deviation of these differences / their mean",
     "equal spokes 0; N at random: sqrt((N - 1) / (N + 1)), near 1"},
    {"adaxial_inner_end", "1",
     "5 % quantile of rho over the nodes of adaxial veins from which all adaxial internodes lead outwards",
     "built-in value of a phantom"},
    {"adaxial_inner_end_least", "1", "the least of them", "built-in value of a phantom"},
    {"adaxial_parts", "1", "connected parts of the adaxial veins", "b0", false},
    {"adaxial_loops", "1", "independent loops: internodes - nodes + parts",
     "b1: tree 0; grid of n x m nodes (n - 1)(m - 1)", false},
    {"adaxial_segments", "1", "chains between nodes with one adaxial internode or three and more; rings count once",
     "grid, tree", false},
    {"reticulation", "1", "adaxial_loops / adaxial_segments", "tree 0; grid", false},
    {"anastomoses_per_area", "1/LENGTH^2",
     "adaxial_loops / area across the axis of the ring from the innermost to the outermost node of adaxial veins",
     "grid"},
    {"adaxial_nodes_degree_N", "1", "nodes of the adaxial section with N adaxial internodes", "grid, tree", false},
    {"divergence_angle", "degree",
     "azimuth from a floret, or whorl of florets, to the next further out: least squares over the lattice of florets "
     "and its centre; 0 to 180 / jugacy",
     "Vogel 1979; golden angle 137.508, Lucas 99.502, bijugate 68.754"},
    {"divergence_angle_low", "degree",
     "lower end of its 95 % interval: bootstrap over florets, 1000 samples (fewer beyond 20000 florets), percentiles",
     "contains the built-in value"},
    {"divergence_angle_high", "degree", "upper end of this interval", "contains the built-in value"},
    {"handedness", "1",
     "1 if, seen from above, florets further and further out turn counterclockwise by the divergence angle; -1 if "
     "clockwise",
     "mirrored phantoms"},
    {"jugacy", "1", "florets of a whorl: greatest common divisor of the numbers of parastichies", "bijugate 2"},
    {"lattice_share", "1",
     "pairs of a floret and the nearest one further out, to each side, that agree with the lattice and each other, of "
     "all; there is no lattice where the share that agrees beyond chance, times the share of florets within 0.3 of a "
     "pair's length of their place, is below 0.5",
     "undisturbed spirals near 1; florets at random: no lattice"},
    {"floret_centre_offset", "1", "distance of the lattice's fitted centre from the axis, in head radii", "phantoms 0"},
    {"parastichies_M_rho_R", "1",
     "visible parastichies at rho R, the smaller number: those along the shortest vectors of the lattice to both "
     "sides; "
     "a reason where less than half of the pairs lie along them",
     "van Iterson 1907; Jean 1994; consecutive Fibonacci or Lucas numbers, or twice Fibonacci numbers"},
    {"parastichies_N_rho_R", "1", "the larger number", "as parastichies_M_rho_R"},
    {"parastichies_share_rho_R", "1",
     "pairs as in lattice_share within 0.1 of rho R that lie along these two families; less where another family "
     "replaces it, or "
     "where florets are irregular",
     "1 away from transitions"},
    {"parastichy_alignment", "1",
     "mean of the absolute cosine between adaxial internodes, projected to the receptacle's tangent plane, and the "
     "nearer of the two visible parastichies there, weighted by their projected lengths, at rho of florets",
     "veins on the spirals 1"},
    {"supply_bundles", "1", "stem bundles: abaxial ends that are lower than the other end of their segment",
     "built-in number of a phantom"},
    {"supplied_florets", "1", "florets that are joined with a stem bundle along veins of any section",
     "built-in number of a phantom"},
    {"supply_sector_width", "degree",
     "mean, over the bundles that are the nearest of a floret along the veins, of the shortest arc of azimuth that "
     "holds "
     "9 of 10 of these florets",
     "spokes 0; one bundle of all florets: near 324"},
    {"supply_overlap_row_K", "1",
     "mean Jaccard index of the K nearest bundles, along the veins, of florets that are among the 8 nearest of each "
     "other and in one radial row (within 30 degrees)",
     "spokes 1"},
    {"supply_overlap_side_K", "1", "the same for florets side by side (within 30 degrees of the direction around)",
     "spokes 0"},
    {"stage_a", "1", "1 if there are abaxial veins, and no adaxial veins and no florets; else 0", "thesis, figure 5.3",
     false},
    {"stage_b", "1",
     "1 if all three sections exist, florets are at the outer rim alone (rho >= 0.75), and nothing is connected; else "
     "0",
     "thesis, figure 5.3"},
    {"stage_c", "1",
     "1 if all three sections exist, florets reach further inwards, and florets are connected with abaxial veins at "
     "the outer rim, and with nothing else; else 0",
     "thesis, figure 5.3"},
    {"stage_d", "1",
     "1 if florets are connected with abaxial veins and, at a smaller median rho, with adaxial veins, and, if adaxial "
     "veins leave the centre free (inner end > 0.2), with each other at a still smaller one; else 0",
     "thesis, figure 5.3"},
};

}  // namespace shvr
