#pragma once
// A flower head: the veins, axis, florets and receptacle's surface that the pattern measures are computed from.

#include "engine/annotation/patterns/head_frame.h"
#include "engine/annotation/patterns/pattern_table.h"

namespace shvr {

inline constexpr double DEGREES = 57.29577951308232;  ///< per radian

/// Height of the surface on which the florets' ends lie, as an even polynomial of the distance from the axis.
struct Receptacle {
    double constant = 0.0, square = 0.0, fourth = 0.0;  ///< of rho
    double rho_least = 0.0, rho_most = 0.0;             ///< where florets are
    /// Slope of the surface outwards: change of height per change of rho, both in radii of the head.
    double slope(double rho) const { return rho * (2.0 * square + 4.0 * fourth * rho * rho); }
};

struct Head {
    VeinGraph graph;
    HeadFrame frame;
    /// Distance of the outermost floret from the axis or, without florets, of the outermost node of any section.
    double radius = 0.0;
    std::vector<glm::dvec3> places{};  ///< position of each node in the frame, in radii of the head
    std::vector<uint32_t> florets{};   ///< indices of nodes: upper ends of florets' veins, and florets without veins
    std::optional<Receptacle> receptacle{};
    double covered = 360.0;  ///< degrees around the axis, without the widest gap between nodes
    std::string doubt{};     ///< why the axis is too uncertain for measures that need it; empty: it is not

    double rho(size_t node) const { return std::hypot(places[node].x, places[node].y); }
    glm::dvec3 middle(const VeinLink& link) const { return 0.5 * (places[link.a] + places[link.b]); }
};

struct FoundHead {
    std::optional<Head> head{};
    std::string reason{};
};
FoundHead find_head(VeinGraph graph, const std::optional<StatedAxis>& stated = {});
/// A head of which less is traced has no measures that hold for a whole turn.
inline constexpr double WHOLE_HEAD_DEGREES = 270.0;

/// Follows the chain of internodes from a node with one internode to the next end or branch, and returns that node.
uint32_t other_end(const VeinGraph& graph, uint32_t end);

/// Quantile of one or more values, interpolated linearly between sorted values (type 7 of Hyndman and Fan 1996).
double quantile(std::vector<double> values, double share);

// Each of these functions computes some of the measures and adds their rows.
void measure_connections(const Head& head, PatternRows& rows);
void measure_veins(const Head& head, PatternRows& rows);
void measure_phyllotaxis(const Head& head, PatternRows& rows);
void measure_supply(const Head& head, PatternRows& rows);
void measure_stages(const Head& head, PatternRows& rows);

/// Computes all measures. If the trace has no axis, returns one row, which states the reason. If the axis is too
/// uncertain, the measures that need it have this reason instead of a value.
PatternRows measure_patterns(const TraceGraph& trace, const HeadSections& sections, const TraceSpace& space,
                             const std::optional<StatedAxis>& stated = {});

}  // namespace shvr
