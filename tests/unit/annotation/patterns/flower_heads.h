#pragma once
// Traces of flower heads for tests: of phantoms, and built from veins.

#include "engine/annotation/patterns/head.h"
#include "engine/volume/phantoms/phantom.h"
#include "tests/support/traces.h"

namespace shvr::test {

inline constexpr uint8_t ABAXIAL_GROUP = 1, ADAXIAL_GROUP = 2, FLORET_GROUP = 3;

/// Collects veins; positions are in the space of the trace.
struct HeadBuilder {
    std::vector<TraceNode> nodes{};
    std::vector<TraceInternode> links{};
    glm::dmat3 turn{1.0};
    glm::dvec3 offset{0.0};

    uint32_t node(const glm::dvec3& at, uint8_t group)
    {
        nodes.push_back({turn * at + offset, 1.0, group});
        return uint32_t(nodes.size() - 1);
    }
    void link(uint32_t a, uint32_t b) { links.push_back({a, b, nodes[b].group}); }
    /// Returns the last node.
    uint32_t vein(const std::vector<glm::dvec3>& places, uint8_t group)
    {
        uint32_t last = node(places[0], group);
        for (size_t i = 1; i < places.size(); ++i) {
            const uint32_t next = node(places[i], group);
            link(last, next);
            last = next;
        }
        return last;
    }
    /// `count` stem bundles that widen into a bowl below height 0, of radius `size`.
    void stem(int count, double size)
    {
        for (int i = 0; i < count; ++i) {
            const double angle = 6.283185307179586 * i / count;
            const auto at = [&](double rho, double height) {
                return size * glm::dvec3(rho * std::cos(angle), rho * std::sin(angle), height);
            };
            vein({at(0.2, -1.0), at(0.2, -0.6), at(0.6, -0.4), at(1.0, -0.1)}, ABAXIAL_GROUP);
        }
    }
    PatternRows measure(const TraceSpace& space = {}, const std::optional<StatedAxis>& stated = {}) const
    {
        return measure_patterns(trace_of(nodes, links),
                                head_sections("", "sections", [](uint8_t) { return SectionGroup{}; }), space, stated);
    }
};

/// The true trace of a phantom, in voxels.
inline HeadBuilder head_of(const Phantom& phantom)
{
    HeadBuilder head;
    for (const auto& node : phantom.nodes) head.node(node.voxel, node.group);
    for (const auto& [from, to] : phantom.links) head.link(uint32_t(from), uint32_t(to));
    return head;
}

inline glm::dvec3 polar(double rho, double degrees, double height = 0.0)
{
    const double angle = degrees * 0.017453292519943295;
    return {rho * std::cos(angle), rho * std::sin(angle), height};
}

}  // namespace shvr::test
