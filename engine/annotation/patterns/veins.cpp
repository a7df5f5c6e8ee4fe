// Course, spacing and network of adaxial veins (thesis 5.2, figure 5.4).

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

#include "engine/annotation/patterns/head.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr double SECTOR_RHOS[] = {0.3, 0.5, 0.7};
constexpr const char* PART_OF_HEAD =
    "the trace covers a part of the head only (covered_angle); expected 270 degrees or more";
constexpr const char* SECTOR_NAMES[] = {"0.3", "0.5", "0.7"};

std::vector<const VeinLink*> adaxial_veins(const Head& head)
{
    std::vector<const VeinLink*> veins;
    for (const VeinLink& link : head.graph.links())
        if (link.is_vein_of(HeadPart::adaxial) && link.length > 0.0) veins.push_back(&link);
    return veins;
}

/// The receptacle's tangent plane at the rho of `at`; if the surface is unknown, a plane perpendicular to the axis.
struct TangentPlane {
    glm::dvec3 outwards, normal;
};
std::optional<TangentPlane> tangent_plane(const glm::dvec3& at, const std::optional<Receptacle>& surface)
{
    const double rho = std::hypot(at.x, at.y);
    if (!(rho > 1e-9)) return {};
    const double slope = surface ? surface->slope(rho) : 0.0, size = std::hypot(1.0, slope);
    const glm::dvec2 radial = glm::dvec2(at) / rho;
    return TangentPlane{glm::dvec3(radial, slope) / size, glm::dvec3(-slope * radial, 1.0) / size};
}

void add_radiality(const Head& head, const std::vector<const VeinLink*>& veins, PatternRows& rows)
{
    double along = 0.0, all = 0.0;
    for (const VeinLink* vein : veins) {
        const auto plane = tangent_plane(head.middle(*vein), head.receptacle);
        if (!plane) continue;
        const glm::dvec3 way = head.places[vein->b] - head.places[vein->a];
        const double outwards = glm::dot(way, plane->outwards);
        const glm::dvec3 around = way - outwards * plane->outwards - glm::dot(way, plane->normal) * plane->normal;
        along += std::abs(outwards);
        all += std::hypot(outwards, glm::length(around));
    }
    if (all > 0.0)
        rows.add("radiality", along / all);
    else
        rows.miss("radiality", "the adaxial veins are parallel to the axis");
}

void add_droop(const Head& head, const std::vector<const VeinLink*>& veins, PatternRows& rows)
{
    if (!head.receptacle) {
        rows.miss("droop", "the receptacle's surface is not known; expected 8 florets or more, over 0.3 of the radius");
        return;
    }
    constexpr double BEYOND = 0.05;  // in head radii: margin around the florets that define the surface
    double sum = 0.0, length = 0.0;
    for (const VeinLink* vein : veins) {
        const glm::dvec3 middle = head.middle(*vein);
        const double rho = std::hypot(middle.x, middle.y);
        if (rho < head.receptacle->rho_least - BEYOND || rho > head.receptacle->rho_most + BEYOND) continue;
        const auto plane = tangent_plane(middle, head.receptacle);
        if (!plane) continue;
        glm::dvec3 inwards = head.places[vein->b] - head.places[vein->a];
        if (glm::dot(inwards, plane->outwards) > 0.0) inwards = -inwards;
        const double below = -glm::dot(inwards, plane->normal), size = glm::length(inwards);
        sum += vein->length * std::asin(std::clamp(below / size, -1.0, 1.0)) * DEGREES;
        length += vein->length;
    }
    if (length > 0.0)
        rows.add("droop", sum / length);
    else
        rows.miss("droop", "no adaxial vein lies below the florets");
}

/// Azimuths, in turns, at which veins cross a circle around the axis.
std::vector<double> crossings_of(const Head& head, const std::vector<const VeinLink*>& veins, double rho)
{
    std::vector<double> azimuths;
    const auto add = [&](const glm::dvec2& at) {
        const double turns = std::atan2(at.y, at.x) / (2.0 * std::numbers::pi);
        azimuths.push_back(turns - std::floor(turns));
    };
    for (const VeinLink* vein : veins) {
        const glm::dvec2 a(head.places[vein->a]), b(head.places[vein->b]), way = b - a;
        const bool is_a_inside = glm::dot(a, a) < rho * rho, is_b_inside = glm::dot(b, b) < rho * rho;
        const double square = glm::dot(way, way), half = glm::dot(a, way);
        const double under = half * half - square * (glm::dot(a, a) - rho * rho);
        if (!(square > 0.0) || !(under > 0.0)) continue;
        const double first = (-half - std::sqrt(under)) / square, second = (-half + std::sqrt(under)) / square;
        if (is_a_inside != is_b_inside) {
            add(a + std::clamp(is_a_inside ? second : first, 0.0, 1.0) * way);
        } else if (!is_a_inside && first > 0.0 && second < 1.0) {
            add(a + first * way);
            add(a + second * way);
        }
    }
    std::ranges::sort(azimuths);
    return azimuths;
}

void add_sectors(const Head& head, const std::vector<const VeinLink*>& veins, PatternRows& rows)
{
    for (size_t i = 0; i < std::size(SECTOR_RHOS); ++i) {
        const std::string at = sentence("_rho_", SECTOR_NAMES[i]);
        const std::vector<double> azimuths = crossings_of(head, veins, SECTOR_RHOS[i]);
        const double count = double(azimuths.size());
        rows.add("sectors_rho_R", "sectors" + at, count);
        if (head.covered < WHOLE_HEAD_DEGREES) {
            for (const char* name : {"sector_gap_mean", "sector_gap_cv"})
                rows.miss(sentence(name, "_rho_R").c_str(), name + at, PART_OF_HEAD);
            continue;
        }
        if (azimuths.size() < 2) {
            for (const char* name : {"sector_gap_mean", "sector_gap_cv"})
                rows.miss(sentence(name, "_rho_R").c_str(), name + at,
                          "fewer than two adaxial veins cross this circle");
            continue;
        }
        double squares = 0.0;
        for (size_t k = 0; k < azimuths.size(); ++k) {
            const double next = k + 1 < azimuths.size() ? azimuths[k + 1] : azimuths[0] + 1.0;
            const double relative = (next - azimuths[k]) * count - 1.0;
            squares += relative * relative;
        }
        rows.add("sector_gap_mean_rho_R", "sector_gap_mean" + at, 360.0 / count);
        rows.add("sector_gap_cv_rho_R", "sector_gap_cv" + at, std::sqrt(squares / count));
    }
}

struct AdaxialNet {
    std::vector<size_t> degrees;  ///< adaxial internodes at each node
    std::vector<bool> is_member;
    size_t links = 0;
};
AdaxialNet net_of(const Head& head, const std::vector<const VeinLink*>& veins)
{
    const size_t count = head.graph.nodes().size();
    AdaxialNet net{std::vector<size_t>(count), std::vector<bool>(count), veins.size()};
    for (size_t node = 0; node < count; ++node)
        net.is_member[node] = head.graph.nodes()[node].part == HeadPart::adaxial;
    for (const VeinLink* vein : veins)
        for (const uint32_t node : {vein->a, vein->b}) {
            ++net.degrees[node];
            net.is_member[node] = true;
        }
    return net;
}

void add_inner_end(const Head& head, const AdaxialNet& net, PatternRows& rows)
{
    std::vector<double> ends;
    double least = 0.0;
    for (uint32_t node = 0; node < net.degrees.size(); ++node) {
        if (net.degrees[node] == 0) continue;
        const bool is_inner = std::ranges::none_of(head.graph.links_of(node), [&](uint32_t link) {
            const VeinLink& vein = head.graph.links()[link];
            return vein.is_vein_of(HeadPart::adaxial) && head.rho(vein.other(node)) < head.rho(node);
        });
        if (!is_inner) continue;
        least = ends.empty() ? head.rho(node) : std::min(least, head.rho(node));
        ends.push_back(head.rho(node));
    }
    rows.add("adaxial_inner_end", quantile(ends, 0.05));
    rows.add("adaxial_inner_end_least", least);
}

/// Number of connected parts, and number of parts that are rings, where all nodes have two links.
std::pair<size_t, size_t> parts_of(const std::vector<const VeinLink*>& veins, const AdaxialNet& net)
{
    std::vector<uint32_t> root(net.degrees.size());
    std::iota(root.begin(), root.end(), 0U);
    const auto find = [&](uint32_t node) {
        while (root[node] != node) node = root[node] = root[root[node]];
        return node;
    };
    for (const VeinLink* vein : veins) root[find(vein->a)] = find(vein->b);
    std::vector<bool> is_ring(root.size(), true);
    for (uint32_t node = 0; node < root.size(); ++node)
        if (net.degrees[node] != 2) is_ring[find(node)] = false;
    size_t parts = 0, rings = 0;
    for (uint32_t node = 0; node < root.size(); ++node) {
        if (root[node] != node || net.degrees[node] == 0) continue;
        ++parts;
        rings += is_ring[node];
    }
    return {parts, rings};
}

void add_reticulation(const Head& head, const std::vector<const VeinLink*>& veins, const AdaxialNet& net,
                      PatternRows& rows)
{
    const auto [parts, rings] = parts_of(veins, net);
    std::array<size_t, 6> histogram{};
    size_t nodes = 0, ends = 0;
    double inner = 1e300, outer = 0.0;
    for (size_t node = 0; node < net.degrees.size(); ++node) {
        if (!net.is_member[node]) continue;
        const size_t degree = net.degrees[node];
        ++histogram[std::min<size_t>(degree, 5)];
        if (degree == 0) continue;
        ++nodes;
        if (degree != 2) ends += degree;
        inner = std::min(inner, head.rho(node));
        outer = std::max(outer, head.rho(node));
    }
    const double loops = double(net.links) - double(nodes) + double(parts);
    const double segments = double(ends) / 2.0 + double(rings);
    rows.add("adaxial_parts", double(parts));
    rows.add("adaxial_loops", loops);
    rows.add("adaxial_segments", segments);
    rows.add("reticulation", loops / segments);
    const double area = std::numbers::pi * (outer * outer - inner * inner) * head.radius * head.radius;
    if (head.covered < WHOLE_HEAD_DEGREES)
        rows.miss("anastomoses_per_area", PART_OF_HEAD);
    else if (area > 0.0)
        rows.add("anastomoses_per_area", loops / area);
    else
        rows.miss("anastomoses_per_area", "the adaxial veins cover no ring around the axis");
    constexpr const char* NAMES[] = {"0", "1", "2", "3", "4", "5_and_more"};
    for (size_t degree = 0; degree < histogram.size(); ++degree)
        rows.add("adaxial_nodes_degree_N", sentence("adaxial_nodes_degree_", NAMES[degree]), double(histogram[degree]));
}

}  // namespace

void measure_veins(const Head& head, PatternRows& rows)
{
    const std::vector<const VeinLink*> veins = adaxial_veins(head);
    if (veins.empty()) {
        for (const char* measure : {"radiality", "droop", "adaxial_inner_end", "adaxial_loops", "reticulation"})
            rows.miss(measure, "the trace has no adaxial veins");
        for (const char* at : SECTOR_NAMES) rows.add("sectors_rho_R", sentence("sectors_rho_", at), 0.0);
        return;
    }
    const AdaxialNet net = net_of(head, veins);
    add_radiality(head, veins, rows);
    add_droop(head, veins, rows);
    add_sectors(head, veins, rows);
    add_inner_end(head, net, rows);
    add_reticulation(head, veins, net, rows);
}

}  // namespace shvr
