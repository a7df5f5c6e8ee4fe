#include "engine/annotation/tracing.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr uint64_t MOST_NUMBERS = uint64_t{1} << 32;

bool is_valid(const TraceNode& node)
{
    const auto is_finite = [](double value) { return value - value == 0.0; };
    return is_finite(node.position.x) && is_finite(node.position.y) && is_finite(node.position.z) &&
           is_finite(node.radius) && node.radius >= 0.0;
}

void drop(std::vector<uint32_t>& ascending, uint32_t number)
{
    ascending.erase(std::lower_bound(ascending.begin(), ascending.end(), number));
}

void keep(std::vector<uint32_t>& ascending, uint32_t number)
{
    ascending.insert(std::lower_bound(ascending.begin(), ascending.end(), number), number);
}

bool holds(const std::vector<uint32_t>& ascending, uint32_t number)
{
    return std::binary_search(ascending.begin(), ascending.end(), number);
}

}  // namespace

std::optional<uint32_t> TraceSelection::node() const
{
    return nodes.size() == 1 && internodes.empty() ? std::optional(nodes[0]) : std::nullopt;
}

std::optional<uint32_t> TraceSelection::internode() const
{
    return internodes.size() == 1 && nodes.empty() ? std::optional(internodes[0]) : std::nullopt;
}

const TraceNode& TraceGraph::node(uint32_t number) const
{
    const auto found = nodes_.find(number);
    SHVR_CHECK(found != nodes_.end(), "node ", number);
    return found->second;
}

const TraceInternode& TraceGraph::internode(uint32_t number) const
{
    const auto found = internodes_.find(number);
    SHVR_CHECK(found != internodes_.end(), "internode ", number);
    return found->second;
}

std::span<const uint32_t> TraceGraph::internodes_of(uint32_t node) const
{
    const auto found = internodes_of_.find(node);
    if (found == internodes_of_.end()) return {};
    return found->second;
}

std::optional<uint32_t> TraceGraph::internode_between(uint32_t a, uint32_t b) const
{
    // Of a node that many internodes meet, the other one's few are searched.
    const uint32_t from = internodes_of(a).size() <= internodes_of(b).size() ? a : b;
    for (const uint32_t number : internodes_of(from))
        if (internode(number).other(from) == (from == a ? b : a)) return number;
    return std::nullopt;
}

double TraceGraph::length_of(const TraceInternode& internode) const
{
    return glm::length(node(internode.b).position - node(internode.a).position);
}

double TraceGraph::radius_of(const TraceInternode& internode, double t) const
{
    const auto size = internode_radii_.find(internode.group);
    if (size != internode_radii_.end()) return size->second;
    return (1.0 - t) * node(internode.a).radius + t * node(internode.b).radius;
}

void TraceGraph::reserve_numbers(uint64_t next_node, uint64_t next_internode)
{
    SHVR_CHECK(next_node <= MOST_NUMBERS && next_internode <= MOST_NUMBERS, next_node, " ", next_internode);
    next_node_ = std::max(next_node_, next_node);
    next_internode_ = std::max(next_internode_, next_internode);
}

std::optional<uint32_t> TraceGraph::nearest_node(const glm::dvec3& position, std::optional<uint32_t> except) const
{
    return index_.nearest(position, except);
}

void TraceGraph::select(TraceSelection selection)
{
    for (const uint32_t number : selection.nodes) SHVR_CHECK(nodes_.contains(number), "node ", number);
    for (const uint32_t number : selection.internodes) SHVR_CHECK(internodes_.contains(number), "internode ", number);
    selection_ = std::move(selection);
}

void TraceGraph::set_node(uint32_t number, const std::optional<TraceNode>& from, const std::optional<TraceNode>& to)
{
    const auto found = nodes_.find(number);
    SHVR_CHECK(from ? found != nodes_.end() && found->second == *from : found == nodes_.end(), "node ", number,
               " is not what the record says");
    SHVR_CHECK(from || to, "node ", number);
    if (to) {
        SHVR_CHECK(is_valid(*to), "node ", number);
        nodes_[number] = *to;
        next_node_ = std::max(next_node_, uint64_t{number} + 1);
        if (!from || from->position != to->position) index_.set(number, to->position);
        return;
    }
    SHVR_CHECK(internodes_of(number).empty(), "node ", number, " still has internodes");
    nodes_.erase(found);
    index_.erase(number);
    if (holds(selection_.nodes, number)) selection_ = {};
}

void TraceGraph::set_internode(uint32_t number, const std::optional<TraceInternode>& from,
                               const std::optional<TraceInternode>& to)
{
    const auto found = internodes_.find(number);
    SHVR_CHECK(from ? found != internodes_.end() && found->second == *from : found == internodes_.end(), "internode ",
               number, " is not what the record says");
    SHVR_CHECK(from || to, "internode ", number);
    if (from && to) {
        SHVR_CHECK(from->a == to->a && from->b == to->b, "internode ", number);
        found->second = *to;
    } else if (to) {
        SHVR_CHECK(to->a != to->b && nodes_.contains(to->a) && nodes_.contains(to->b), "internode ", number, " joins ",
                   to->a, " and ", to->b);
        SHVR_CHECK(!internode_between(to->a, to->b), "internode ", number, " joins ", to->a, " and ", to->b, " again");
        internodes_[number] = *to;
        for (const uint32_t end : {to->a, to->b}) keep(internodes_of_[end], number);
        next_internode_ = std::max(next_internode_, uint64_t{number} + 1);
    } else {
        for (const uint32_t end : {from->a, from->b}) {
            drop(internodes_of_[end], number);
            if (internodes_of_[end].empty()) internodes_of_.erase(end);
        }
        internodes_.erase(found);
        if (holds(selection_.internodes, number)) selection_ = {};
    }
}

void TraceGraph::apply(const TraceChange& change, Direction direction)
{
    const bool forwards = direction == Direction::forwards;
    std::visit(
        [&](const auto& record) {
            using Record = std::decay_t<decltype(record)>;
            const auto& from = forwards ? record.before : record.after;
            const auto& to = forwards ? record.after : record.before;
            if constexpr (std::is_same_v<Record, TraceNodeChange>) {
                set_node(record.node, from, to);
            } else if constexpr (std::is_same_v<Record, TraceInternodeChange>) {
                set_internode(record.internode, from, to);
            } else if constexpr (std::is_same_v<Record, TraceSizeChange>) {
                const auto found = internode_radii_.find(record.group);
                const std::optional<double> now =
                    found == internode_radii_.end() ? std::nullopt : std::optional(found->second);
                SHVR_CHECK(now == from, "size of group ", int(record.group));
                if (to)
                    internode_radii_[record.group] = *to;
                else
                    internode_radii_.erase(record.group);
            } else {
                select(to);
            }
        },
        change);
}

bool operator==(const TraceGraph& left, const TraceGraph& right)
{
    return left.nodes_ == right.nodes_ && left.internodes_ == right.internodes_ &&
           left.internode_radii_ == right.internode_radii_;
}

}  // namespace shvr
