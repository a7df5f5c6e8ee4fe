#include "engine/annotation/patterns/vein_graph.h"

#include <algorithm>

namespace shvr {

VeinGraph::VeinGraph(const TraceGraph& trace, const HeadSections& sections, const TraceSpace& space)
{
    std::vector<uint32_t> numbers;  // ascending, as the trace's nodes are
    for (const auto& [number, node] : trace.nodes()) {
        numbers.push_back(number);
        nodes_.push_back({physical_of(space, node.position), sections.parts[node.group]});
    }
    const auto index = [&](uint32_t number) {
        return uint32_t(std::ranges::lower_bound(numbers, number) - numbers.begin());
    };
    first_.assign(nodes_.size() + 1, 0);
    for (const auto& [number, internode] : trace.internodes()) {
        const uint32_t a = index(internode.a), b = index(internode.b);
        const HeadPart of_a = nodes_[a].part, of_b = nodes_[b].part;
        const HeadPart own = sections.parts[internode.group];
        links_.push_back({.a = a,
                          .b = b,
                          .part = own == HeadPart::none && of_a == of_b ? of_a : own,
                          .is_connection = of_a != of_b && of_a != HeadPart::none && of_b != HeadPart::none,
                          .length = glm::length(nodes_[a].at - nodes_[b].at)});
        ++first_[a + 1];
        ++first_[b + 1];
    }
    for (size_t i = 0; i < nodes_.size(); ++i) first_[i + 1] += first_[i];
    ends_.resize(2 * links_.size());
    std::vector<size_t> next(first_.begin(), first_.end() - 1);
    for (size_t i = 0; i < links_.size(); ++i)
        for (const uint32_t node : {links_[i].a, links_[i].b}) ends_[next[node]++] = uint32_t(i);
}

size_t VeinGraph::count(HeadPart part) const
{
    return size_t(std::ranges::count(nodes_, part, &VeinNode::part));
}

}  // namespace shvr
