#pragma once
// A flower head: its veins, its axis, its florets and its receptacle's surface, as measures of patterns need them.

#include "engine/annotation/patterns/head_frame.h"
#include "engine/annotation/patterns/pattern_table.h"

namespace shvr {

inline constexpr double DEGREES = 57.29577951308232;  ///< per radian

/// Height of the surface on which the florets' ends lie, as an even polynomial of the distance from the axis.
struct Receptacle {
    double constant = 0.0, square = 0.0, fourth = 0.0;  ///< of rho
    double rho_least = 0.0, rho_most = 0.0;             ///< where florets are
    /// Slope of the height outwards, both in radii of the head.
    double slope(double rho) const { return rho * (2.0 * square + 4.0 * fourth * rho * rho); }
};

struct Head {
    VeinGraph graph;
    HeadFrame frame;
    /// Distance from the axis of the outermost floret; without florets, of the outermost node of a section.
    double radius = 0.0;
    std::vector<glm::dvec3> places{};  ///< position of each node in the frame, in radii of the head
    std::vector<uint32_t> florets{};   ///< nodes: upper ends of florets' veins, and florets without veins
    std::optional<Receptacle> receptacle{};

    double rho(size_t node) const { return std::hypot(places[node].x, places[node].y); }
    glm::dvec3 middle(const VeinLink& link) const { return 0.5 * (places[link.a] + places[link.b]); }
};

struct FoundHead {
    std::optional<Head> head{};
    std::string reason{};
};
FoundHead find_head(VeinGraph graph);

/// The other end of the chain that begins at a node with one internode: an end or a branch.
uint32_t other_end(const VeinGraph& graph, uint32_t end);

/// Quantile by linear interpolation between the sorted values (type 7 of Hyndman and Fan 1996). At least one value.
double quantile(std::vector<double> values, double share);

// The measures, in parts; each adds its rows.
void measure_connections(const Head& head, PatternRows& rows);
void measure_veins(const Head& head, PatternRows& rows);
void measure_phyllotaxis(const Head& head, PatternRows& rows);
void measure_supply(const Head& head, PatternRows& rows);
void measure_stages(const Head& head, PatternRows& rows);

/// All of them. A trace that has no axis gets one row with the reason.
PatternRows measure_patterns(const TraceGraph& trace, const HeadSections& sections, const TraceSpace& space);

}  // namespace shvr
