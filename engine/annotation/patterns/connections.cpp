// Connections between sections of a flower head, and the stages of development (thesis 5.2, figure 5.3).

#include <algorithm>
#include <array>
#include <limits>
#include <queue>

#include "engine/annotation/patterns/head.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

struct PairOfParts {
    HeadPart a, b;
};
constexpr PairOfParts PAIRS[] = {{HeadPart::abaxial, HeadPart::adaxial},
                                 {HeadPart::abaxial, HeadPart::floret},
                                 {HeadPart::adaxial, HeadPart::floret}};
constexpr double BINS[] = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0};

/// The rho (distance from the axis in head radii) of each connection between two parts. A connection is an internode
/// that joins nodes of both, or a node where veins of both meet, unless such an internode ends there.
std::vector<double> connections_of(const Head& head, HeadPart one, HeadPart other)
{
    std::vector<double> found;
    const VeinGraph& graph = head.graph;
    std::vector<bool> is_joined(graph.nodes().size());
    for (const VeinLink& link : graph.links()) {
        const HeadPart a = graph.nodes()[link.a].part, b = graph.nodes()[link.b].part;
        if (!(a == one && b == other) && !(a == other && b == one)) continue;
        const glm::dvec3 middle = head.middle(link);
        found.push_back(std::hypot(middle.x, middle.y));
        is_joined[link.a] = is_joined[link.b] = true;
    }
    for (size_t node = 0; node < graph.nodes().size(); ++node) {
        if (is_joined[node]) continue;
        bool has_one = false, has_other = false;
        for (const uint32_t link : graph.links_of(node)) {
            has_one |= graph.links()[link].is_vein_of(one);
            has_other |= graph.links()[link].is_vein_of(other);
        }
        if (has_one && has_other) found.push_back(head.rho(node));
    }
    return found;
}

/// The rho of each connection between florets' veins. A node of these veins belongs to the floret that is nearest along
/// the veins; an internode whose nodes belong to different florets is a connection.
std::vector<double> floret_connections_of(const Head& head)
{
    const VeinGraph& graph = head.graph;
    constexpr uint32_t NOBODY = std::numeric_limits<uint32_t>::max();
    std::vector<uint32_t> owner(graph.nodes().size(), NOBODY);
    using Arrival = std::tuple<double, uint32_t, uint32_t>;  // way, floret, node
    std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> arrivals;
    for (const uint32_t floret : head.florets) arrivals.emplace(0.0, floret, floret);
    while (!arrivals.empty()) {
        const auto [way, floret, node] = arrivals.top();
        arrivals.pop();
        if (owner[node] != NOBODY) continue;
        owner[node] = floret;
        for (const uint32_t i : graph.links_of(node)) {
            const VeinLink& link = graph.links()[i];
            if (link.is_vein_of(HeadPart::floret)) arrivals.emplace(way + link.length, floret, link.other(node));
        }
    }
    std::vector<double> found;
    for (const VeinLink& link : graph.links()) {
        if (!link.is_vein_of(HeadPart::floret) || owner[link.a] == NOBODY || owner[link.a] == owner[link.b]) continue;
        const glm::dvec3 middle = head.middle(link);
        found.push_back(std::hypot(middle.x, middle.y));
    }
    return found;
}

void add_rows(const std::string& pair, const std::vector<double>& rhos, PatternRows& rows)
{
    const std::string name = "connections_" + pair;
    rows.add("connections_A_B", name, double(rhos.size()));
    const std::pair<const char*, double> quantiles[] = {{"_rho_least", 0.0}, {"_rho_median", 0.5}, {"_rho_most", 1.0}};
    for (const auto& [which, share] : quantiles) {
        const std::string measure = sentence("connections_A_B", which);
        if (rhos.empty())
            rows.miss(measure.c_str(), name + which, "there is no such connection");
        else
            rows.add(measure.c_str(), name + which, quantile(rhos, share));
    }
    if (rhos.empty()) return;
    for (size_t bin = 0; bin < std::size(BINS); ++bin) {
        const bool is_last = bin + 1 == std::size(BINS);
        const double below = is_last ? std::numeric_limits<double>::infinity() : BINS[bin + 1];
        const auto count = std::ranges::count_if(rhos, [&](double rho) { return rho >= BINS[bin] && rho < below; });
        constexpr const char* NAMES[] = {"0.0_to_0.2", "0.2_to_0.4", "0.4_to_0.6",
                                         "0.6_to_0.8", "0.8_to_1.0", "1.0_and_more"};
        rows.add("connections_A_B_rho_FROM_to_TO", name + "_rho_" + NAMES[bin], double(count));
    }
}

constexpr double RIM = 0.75;         ///< rho at the inner border of the outer rim
constexpr double FREE_CENTRE = 0.2;  ///< if the inner ends of veins have a greater rho, the centre is free of veins

}  // namespace

void measure_connections(const Head& head, PatternRows& rows)
{
    for (const auto& [a, b] : PAIRS) add_rows(sentence(name_of(a), "_", name_of(b)), connections_of(head, a, b), rows);
    add_rows("floret_floret", floret_connections_of(head), rows);
}

void measure_stages(const Head& head, PatternRows& rows)
{
    const auto count = [&](const char* pair) { return rows.value(sentence("connections_", pair)).value_or(0.0); };
    const auto rho = [&](const char* pair, const char* which, double missing) {
        return rows.value(sentence("connections_", pair, "_rho_", which)).value_or(missing);
    };
    const bool has_abaxial = head.graph.count(HeadPart::abaxial) > 0;
    const bool has_adaxial = head.graph.count(HeadPart::adaxial) > 0;
    const bool has_florets = !head.florets.empty();
    double innermost = 2.0;
    for (const uint32_t floret : head.florets) innermost = std::min(innermost, head.rho(floret));
    const double of_rim = count("abaxial_floret"), between = count("adaxial_floret"), centre = count("floret_floret");
    const bool all = has_abaxial && has_adaxial && has_florets;
    const bool leaves_centre = rows.value("adaxial_inner_end").value_or(0.0) > FREE_CENTRE;
    const bool is_rim_outside = rho("abaxial_floret", "median", 0.0) > rho("adaxial_floret", "median", 9.0);
    const bool is_centre_inside = rho("floret_floret", "median", 9.0) < rho("adaxial_floret", "median", 0.0);
    const std::pair<const char*, bool> stages[] = {
        {"stage_a", has_abaxial && !has_adaxial && head.graph.count(HeadPart::floret) == 0},
        {"stage_b", all && innermost >= RIM && of_rim + between + centre + count("abaxial_adaxial") == 0.0},
        {"stage_c", all && innermost < RIM && of_rim > 0.0 && rho("abaxial_floret", "least", 0.0) >= RIM &&
                        between + centre == 0.0},
        {"stage_d", all && innermost < RIM && of_rim > 0.0 && between > 0.0 && is_rim_outside &&
                        (!leaves_centre || is_centre_inside)},
    };
    for (const auto& [stage, holds] : stages) rows.add(stage, holds ? 1.0 : 0.0);
}

}  // namespace shvr
