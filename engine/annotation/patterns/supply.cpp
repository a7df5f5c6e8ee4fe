// Sectoriality of supply: which stem bundles are nearest to each floret, along the veins (thesis 5.2).

#include <algorithm>
#include <array>
#include <numbers>
#include <queue>

#include "engine/annotation/patterns/head.h"
#include "engine/annotation/patterns/neighbours.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr size_t MAX_BUNDLES = 3, MIN_SUPPLIED = 8;

/// Lower ends of abaxial veins.
std::vector<uint32_t> stem_bundles(const Head& head)
{
    std::vector<uint32_t> bundles;
    for (uint32_t node = 0; node < head.graph.nodes().size(); ++node) {
        if (head.graph.nodes()[node].part != HeadPart::abaxial || head.graph.links_of(node).size() != 1) continue;
        if (head.places[node].z < head.places[other_end(head.graph, node)].z) bundles.push_back(node);
    }
    return bundles;
}

/// For each node, the up to three bundles with the shortest paths along the veins, nearest first; by Dijkstra's
/// algorithm, in which a node may be reached from three bundles.
using Supply = std::vector<std::vector<uint32_t>>;
Supply supply_of(const Head& head, const std::vector<uint32_t>& bundles)
{
    Supply supply(head.graph.nodes().size());
    using Arrival = std::tuple<double, uint32_t, uint32_t>;  // way, bundle, node
    std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> arrivals;
    for (const uint32_t bundle : bundles) arrivals.emplace(0.0, bundle, bundle);
    while (!arrivals.empty()) {
        const auto [way, bundle, node] = arrivals.top();
        arrivals.pop();
        if (supply[node].size() == MAX_BUNDLES || std::ranges::count(supply[node], bundle) > 0) continue;
        supply[node].push_back(bundle);
        for (const uint32_t i : head.graph.links_of(node)) {
            const VeinLink& link = head.graph.links()[i];
            if (supply[link.other(node)].size() < MAX_BUNDLES)
                arrivals.emplace(way + link.length, bundle, link.other(node));
        }
    }
    return supply;
}

/// Jaccard index of the sets of the `count` bundles nearest to each of two florets.
double overlap(const std::vector<uint32_t>& one, const std::vector<uint32_t>& other, size_t count)
{
    const size_t ones = std::min(count, one.size()), others = std::min(count, other.size());
    double shared = 0.0;
    for (size_t i = 0; i < ones; ++i)
        shared += double(std::count(other.begin(), other.begin() + ptrdiff_t(others), one[i]));
    return shared / (double(ones + others) - shared);
}

/// Adds the mean overlaps of neighbouring florets: along a radius (row), and around the axis (side).
void add_overlaps(const Head& head, const std::vector<uint32_t>& florets, const Supply& supply, PatternRows& rows)
{
    std::vector<glm::dvec3> places;
    TraceIndex index;
    for (uint32_t i = 0; i < florets.size(); ++i) {
        places.push_back(head.places[florets[i]]);
        index.set(i, places.back());
    }
    std::array<double, MAX_BUNDLES> row{}, side{};
    double in_row = 0.0, beside = 0.0;
    for (uint32_t i = 0; i < florets.size(); ++i)
        for (const uint32_t j : neighbours_of(index, places, i, 8)) {
            const glm::dvec3 middle = 0.5 * (places[i] + places[j]), way = places[j] - places[i];
            const double rho = std::hypot(middle.x, middle.y), length = glm::length(way);
            if (j == i || !(rho > 0.0) || !(length > 0.0)) continue;
            const double around = std::abs(way.y * middle.x - way.x * middle.y) / rho / length;
            const bool is_row = around<0.5, is_side = around> std::sqrt(0.75);  // 30 degrees
            in_row += is_row;
            beside += is_side;
            for (size_t k = 0; k < MAX_BUNDLES; ++k) {
                if (!is_row && !is_side) continue;
                (is_row ? row : side)[k] += overlap(supply[florets[i]], supply[florets[j]], k + 1);
            }
        }
    for (size_t k = 0; k < MAX_BUNDLES; ++k) {
        const auto add = [&](const char* measure, const char* name, double sum, double count) {
            if (count > 0.0)
                rows.add(measure, sentence(name, k + 1), sum / count);
            else
                rows.miss(measure, sentence(name, k + 1), "no neighbouring florets lie this way");
        };
        add("supply_overlap_row_K", "supply_overlap_row_", row[k], in_row);
        add("supply_overlap_side_K", "supply_overlap_side_", side[k], beside);
    }
}

/// Mean, over all bundles, of the shortest arc that contains 9 of 10 florets whose nearest bundle is this one.
double sector_width(const Head& head, const std::vector<uint32_t>& florets, const Supply& supply)
{
    std::vector<std::pair<uint32_t, double>> turns;  // bundle, azimuth in turns
    for (const uint32_t floret : florets) {
        const double turn = std::atan2(head.places[floret].y, head.places[floret].x) / (2.0 * std::numbers::pi);
        turns.emplace_back(supply[floret][0], turn - std::floor(turn));
    }
    std::ranges::sort(turns);
    double sum = 0.0, bundles = 0.0;
    for (size_t from = 0, to = 0; from < turns.size(); from = to) {
        while (to < turns.size() && turns[to].first == turns[from].first) ++to;
        const size_t count = to - from, held = (9 * count + 9) / 10;
        double least = 1.0;
        for (size_t i = 0; i < count; ++i) {
            const size_t last = i + held - 1;
            const double end = turns[from + last % count].second + (last >= count ? 1.0 : 0.0);
            least = std::min(least, end - turns[from + i].second);
        }
        sum += least;
        bundles += 1.0;
    }
    return 360.0 * sum / bundles;
}

}  // namespace

void measure_supply(const Head& head, PatternRows& rows)
{
    if (!head.frame.knows_up) return rows.miss("supply_bundles", "nothing in the trace tells above from below");
    const std::vector<uint32_t> bundles = stem_bundles(head);
    rows.add("supply_bundles", double(bundles.size()));
    const Supply supply = supply_of(head, bundles);
    std::vector<uint32_t> florets;
    for (const uint32_t floret : head.florets)
        if (!supply[floret].empty()) florets.push_back(floret);
    rows.add("supplied_florets", double(florets.size()));
    if (bundles.size() < 2 || florets.size() < MIN_SUPPLIED)
        return rows.miss("supply_sector_width",
                         sentence("expected 2 bundles or more, joined with ", MIN_SUPPLIED, " florets or more"));
    rows.add("supply_sector_width", sector_width(head, florets, supply));
    add_overlaps(head, florets, supply, rows);
}

}  // namespace shvr
