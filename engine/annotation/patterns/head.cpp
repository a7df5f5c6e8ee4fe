#include "engine/annotation/patterns/head.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace shvr {

namespace {

std::vector<uint32_t> florets_of(const VeinGraph& graph, const HeadFrame& frame)
{
    std::vector<uint32_t> florets;
    for (uint32_t node = 0; node < graph.nodes().size(); ++node) {
        if (graph.nodes()[node].part != HeadPart::floret || graph.links_of(node).size() > 1) continue;
        const bool is_alone = graph.links_of(node).empty();
        const auto height = [&](uint32_t of) { return frame.local(graph.nodes()[of].at).z; };
        if (is_alone || (frame.knows_up && height(node) > height(other_end(graph, node)))) florets.push_back(node);
    }
    return florets;
}

/// Fits the height by least squares as a polynomial in 1, rho^2 and, with 20 florets or more, rho^4. Null if there are
/// too few florets, or if they lie on a narrow ring, since such florets do not determine the surface.
std::optional<Receptacle> receptacle_of(const Head& head)
{
    Receptacle surface{.rho_least = 2.0};
    for (const uint32_t floret : head.florets) {
        surface.rho_least = std::min(surface.rho_least, head.rho(floret));
        surface.rho_most = std::max(surface.rho_most, head.rho(floret));
    }
    if (head.florets.size() < 8 || surface.rho_most - surface.rho_least < 0.3) return {};
    const bool is_fourth = head.florets.size() >= 20;
    glm::dmat3 normal(0.0);
    glm::dvec3 right(0.0);
    for (const uint32_t floret : head.florets) {
        const double square = head.rho(floret) * head.rho(floret);
        const glm::dvec3 terms(1.0, square, is_fourth ? square * square : 0.0);
        normal += glm::outerProduct(terms, terms);
        right += head.places[floret].z * terms;
    }
    if (!is_fourth) normal[2][2] = 1.0;
    const glm::dvec3 found = glm::inverse(normal) * right;
    if (!(std::abs(found.x) + std::abs(found.y) + std::abs(found.z) < 1e6)) return {};
    surface.constant = found.x;
    surface.square = found.y;
    surface.fourth = found.z;
    return surface;
}

constexpr double MAX_DEGREES = 5.0, MAX_OFF = 0.05;  ///< larger errors of an axis spoil the measures; in head radii

/// A turn less the widest gap of azimuth between nodes, except near the axis.
double covered_degrees(const Head& head)
{
    std::vector<double> azimuths;
    for (size_t node = 0; node < head.places.size(); ++node)
        if (head.graph.nodes()[node].part != HeadPart::none && head.rho(node) > 0.3)
            azimuths.push_back(DEGREES * std::atan2(head.places[node].y, head.places[node].x));
    if (azimuths.empty()) return 0.0;
    std::ranges::sort(azimuths);
    double widest = azimuths.front() + 360.0 - azimuths.back();
    for (size_t i = 1; i < azimuths.size(); ++i) widest = std::max(widest, azimuths[i] - azimuths[i - 1]);
    return 360.0 - widest;
}

std::string doubt_about(const Head& head)
{
    if (!head.frame.error) return {};
    const auto& [degrees, length, is_ambiguous] = *head.frame.error;
    const double off = length / head.radius;
    const auto rounded = [](double value, double step) {
        std::string text = std::to_string(std::round(value / step) * step);
        return text.substr(0, text.find('.') + (step < 1.0 ? (step < 0.1 ? 4 : 2) : 0));
    };
    const std::string covers =
        sentence("the nodes cover ", rounded(head.covered, 1.0), " degrees around the axis and do not determine it: ");
    const char* const help = "; trace more of the head, or state its axis (option axis)";
    if (is_ambiguous) return covers + "another axis fits nearly as well" + help;
    if (degrees <= MAX_DEGREES && off <= MAX_OFF) return {};
    return sentence(covers, "its direction is certain to ", rounded(std::min(degrees, 90.0), 0.1),
                    " degrees and its place to ", rounded(std::min(off, 9.0), 0.001),
                    " head radii (99 of 100 traces), expected 5 and 0.05", help);
}

void add_axis(const Head& head, PatternRows& rows)
{
    const HeadFrame& frame = head.frame;
    rows.add("head_radius", head.radius);
    const auto place = [&](double along) { return std::abs(along) < 1e-9 * head.radius ? 0.0 : along; };
    rows.add("axis_x", place(frame.centre.x));
    rows.add("axis_y", place(frame.centre.y));
    rows.add("axis_z", place(frame.centre.z));
    rows.add("axis_direction_x", frame.up.x);
    rows.add("axis_direction_y", frame.up.y);
    rows.add("axis_direction_z", frame.up.z);
    const char* const no_veins = "no abaxial veins lie around the axis, so it is a principal axis of inertia";
    if (frame.residual_degrees)
        rows.add("axis_residual", *frame.residual_degrees);
    else
        rows.miss("axis_residual", frame.is_stated ? "the trace has no abaxial veins" : no_veins);
    if (frame.error) {
        rows.add("axis_direction_error", std::min(frame.error->degrees, 90.0));
        rows.add("axis_place_error", std::min(frame.error->length / head.radius, 9.0));
    } else {
        for (const char* measure : {"axis_direction_error", "axis_place_error"})
            rows.miss(measure, frame.is_stated ? "the axis is stated" : no_veins);
    }
    rows.add("covered_angle", head.covered);
}

}  // namespace

uint32_t other_end(const VeinGraph& graph, uint32_t end)
{
    uint32_t node = end;
    for (uint32_t link = graph.links_of(end)[0];;) {
        node = graph.links()[link].other(node);
        const auto links = graph.links_of(node);
        if (links.size() != 2 || node == end) return node;
        link = links[0] == link ? links[1] : links[0];
    }
}

double quantile(std::vector<double> values, double share)
{
    std::ranges::sort(values);
    const double at = share * double(values.size() - 1);
    const size_t below = std::min(size_t(at), values.size() - 1), above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - double(below)) * (values[above] - values[below]);
}

FoundHead find_head(VeinGraph graph, const std::optional<StatedAxis>& stated)
{
    FoundFrame found = fit_frame(graph, stated);
    if (!found.frame) return {.reason = found.reason};
    Head head{.graph = std::move(graph), .frame = *found.frame};
    head.florets = florets_of(head.graph, head.frame);
    const auto distance = [&](const VeinNode& node) {
        const glm::dvec3 p = head.frame.local(node.at);
        return std::hypot(p.x, p.y);
    };
    for (const uint32_t floret : head.florets)
        head.radius = std::max(head.radius, distance(head.graph.nodes()[floret]));
    if (!(head.radius > 0.0))
        for (const VeinNode& node : head.graph.nodes())
            if (node.part != HeadPart::none) head.radius = std::max(head.radius, distance(node));
    for (const VeinNode& node : head.graph.nodes()) head.places.push_back(head.frame.local(node.at) / head.radius);
    head.receptacle = receptacle_of(head);
    head.covered = covered_degrees(head);
    head.doubt = doubt_about(head);
    return {.head = std::move(head)};
}

PatternRows measure_patterns(const TraceGraph& trace, const HeadSections& sections, const TraceSpace& space,
                             const std::optional<StatedAxis>& stated)
{
    PatternRows rows;
    FoundHead found = find_head(VeinGraph(trace, sections, space), stated);
    if (!found.head) {
        rows.miss("head_radius", found.reason);
        return rows;
    }
    const Head& head = *found.head;
    add_axis(head, rows);
    for (const HeadPart part : HEAD_PARTS) {
        double length = 0.0;
        for (const VeinLink& link : head.graph.links()) length += link.is_vein_of(part) ? link.length : 0.0;
        rows.add("vein_length_A", sentence("vein_length_", name_of(part)), length);
    }
    rows.add("florets", double(head.florets.size()));
    measure_connections(head, rows);
    measure_veins(head, rows);
    measure_phyllotaxis(head, rows);
    measure_supply(head, rows);
    measure_stages(head, rows);
    if (!head.doubt.empty()) rows.withdraw(head.doubt);
    return rows;
}

}  // namespace shvr
