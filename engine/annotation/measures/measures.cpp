#include "engine/annotation/measures/measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/annotation/trace/trace_forms.h"

namespace shvr {

namespace {

SegmentMeasures measures_of(const TraceGraph& trace, const TraceSegment& segment)
{
    SegmentMeasures measures;
    measures.internode = *std::ranges::min_element(segment.internodes);
    measures.from = segment.nodes.front();
    measures.to = segment.nodes.back();
    measures.internodes = segment.internodes.size();
    measures.chord = glm::length(trace.node(measures.to).position - trace.node(measures.from).position);
    std::map<uint8_t, double> by_group;
    double radius_sum = 0.0, radius_plain_sum = 0.0;
    for (const uint32_t number : segment.internodes) {
        const TraceInternode& internode = trace.internode(number);
        const double length = trace.length_of(internode);
        const double a = trace.radius_of(internode, 0.0), b = trace.radius_of(internode, 1.0);
        const bool is_first = number == segment.internodes.front();
        measures.length += length;
        by_group[internode.group] += length;
        radius_sum += length * (a + b) / 2.0;
        radius_plain_sum += (a + b) / 2.0;
        measures.radius_least = is_first ? std::min(a, b) : std::min({measures.radius_least, a, b});
        measures.radius_most = std::max({measures.radius_most, a, b});
    }
    measures.radius_mean =
        measures.length > 0.0 ? radius_sum / measures.length : radius_plain_sum / double(segment.internodes.size());
    measures.group = std::ranges::max_element(by_group, {}, [](const auto& pair) { return pair.second; })->first;
    if (measures.chord > 0.0) measures.tortuosity = measures.length / measures.chord;
    return measures;
}

/// Uses atan2, which is accurate near 0 and 180 degrees, unlike the arc cosine.
double angle_degrees(const glm::dvec3& a, const glm::dvec3& b)
{
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

BranchMeasures branch_of(const TraceGraph& trace, uint32_t node)
{
    BranchMeasures branch{node, trace.node(node).group, {}};
    std::vector<glm::dvec3> ways;
    for (const uint32_t internode : trace.internodes_of(node))
        ways.push_back(trace.node(trace.internode(internode).other(node)).position - trace.node(node).position);
    for (size_t a = 0; a < ways.size(); ++a)
        for (size_t b = a + 1; b < ways.size(); ++b) branch.angles_degrees.push_back(angle_degrees(ways[a], ways[b]));
    return branch;
}

}  // namespace

std::string csv_field(std::string text)
{
    if (!text.empty() && std::string_view("=+-@").find(text[0]) != std::string_view::npos) text = "'" + text;
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char character : text) quoted += character == '"' ? std::string("\"\"") : std::string(1, character);
    return quoted + "\"";
}

Topology topology_of(const TraceGraph& trace)
{
    std::vector<std::string> notes;
    const auto loops = int64_t(trees_of(trace, Loops::break_open, "", notes).left_out.size());
    return {.components = int64_t(trace.nodes().size()) - int64_t(trace.internodes().size()) + loops, .loops = loops};
}

TraceMeasures measure(const TraceGraph& trace)
{
    TraceMeasures measures;
    for (const auto& [number, node] : trace.nodes()) {
        ++measures.nodes_by_group[node.group];
        const size_t degree = trace.internodes_of(number).size();
        measures.ends += degree == 1;
        if (degree > 2) measures.branches.push_back(branch_of(trace, number));
    }
    for (const auto& [number, internode] : trace.internodes()) {
        ++measures.internodes_by_group[internode.group];
        measures.length_by_group[internode.group] += trace.length_of(internode);
    }
    for (const TraceSegment& segment : segments_of(trace)) measures.segments.push_back(measures_of(trace, segment));
    measures.topology = topology_of(trace);
    return measures;
}

std::string metrics_csv(const TraceMeasures& trace, const std::array<int64_t, 256>& voxels_by_group,
                        const std::map<int, Topology>& mask_topology, const TraceSpace& space)
{
    const std::string unit = csv_field(space.unit), cubed = csv_field(space.unit + "^3");
    std::string text = "item,number,group,measure,value,unit\r\n";
    const auto row = [&](const char* item, const std::string& number, const std::string& group,
                         const std::string& measure, const std::string& value, const std::string& row_unit) {
        text += std::string(item) + "," + number + "," + group + "," + measure + "," + value + "," + row_unit + "\r\n";
    };
    const auto topology = [&](const char* item, const std::string& group, const Topology& of, bool has_cavities) {
        row(item, "", group, "components", std::to_string(of.components), "1");
        row(item, "", group, "loops", std::to_string(of.loops), "1");
        if (has_cavities) row(item, "", group, "cavities", std::to_string(of.cavities), "1");
    };
    const double voxel_volume = space.spacing.x * space.spacing.y * space.spacing.z;
    for (size_t group = 1; group < 256; ++group) {
        if (voxels_by_group[group] == 0) continue;
        row("mask", "", std::to_string(group), "voxels", std::to_string(voxels_by_group[group]), "voxel");
        row("mask", "", std::to_string(group), "volume", digits_of(double(voxels_by_group[group]) * voxel_volume),
            cubed);
    }
    for (const auto& [group, of] : mask_topology) topology("mask", group < 0 ? "" : std::to_string(group), of, true);
    for (const auto& [group, count] : trace.nodes_by_group)
        row("trace", "", std::to_string(group), "nodes", std::to_string(count), "1");
    for (const auto& [group, count] : trace.internodes_by_group)
        row("trace", "", std::to_string(group), "internodes", std::to_string(count), "1");
    for (const auto& [group, length] : trace.length_by_group)
        row("trace", "", std::to_string(group), "length", digits_of(length), unit);
    row("trace", "", "", "segments", std::to_string(trace.segments.size()), "1");
    row("trace", "", "", "branches", std::to_string(trace.branches.size()), "1");
    row("trace", "", "", "ends", std::to_string(trace.ends), "1");
    topology("trace", "", trace.topology, false);
    for (const SegmentMeasures& segment : trace.segments) {
        const std::string number = std::to_string(segment.internode), group = std::to_string(segment.group);
        row("segment", number, group, "from_node", std::to_string(segment.from), "1");
        row("segment", number, group, "to_node", std::to_string(segment.to), "1");
        row("segment", number, group, "internodes", std::to_string(segment.internodes), "1");
        row("segment", number, group, "length", digits_of(segment.length), unit);
        row("segment", number, group, "chord", digits_of(segment.chord), unit);
        if (segment.tortuosity) row("segment", number, group, "tortuosity", digits_of(*segment.tortuosity), "1");
        row("segment", number, group, "radius_mean", digits_of(segment.radius_mean), unit);
        row("segment", number, group, "radius_least", digits_of(segment.radius_least), unit);
        row("segment", number, group, "radius_most", digits_of(segment.radius_most), unit);
    }
    for (const BranchMeasures& branch : trace.branches)
        for (const double angle : branch.angles_degrees)
            row("branch", std::to_string(branch.node), std::to_string(branch.group), "angle", digits_of(angle),
                "degree");
    return text;
}

}  // namespace shvr
