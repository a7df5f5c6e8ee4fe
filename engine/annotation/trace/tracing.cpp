#include "engine/annotation/trace/tracing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr uint64_t MAX_NUMBERS = uint64_t{1} << 32;

bool is_radius(double radius)
{
    return std::isfinite(radius) && radius >= 0.0;
}

bool is_valid(const TraceNode& node)
{
    return std::isfinite(node.position.x) && std::isfinite(node.position.y) && std::isfinite(node.position.z) &&
           is_radius(node.radius);
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
    // Searches the node with fewer internodes.
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
    SHVR_CHECK(next_node <= MAX_NUMBERS && next_internode <= MAX_NUMBERS, next_node, " ", next_internode);
    next_node_ = std::max(next_node_, next_node);
    next_internode_ = std::max(next_internode_, next_internode);
}

std::optional<uint32_t> TraceGraph::nearest_node(const glm::dvec3& position, std::optional<uint32_t> except) const
{
    return index_.nearest(position, except);
}

std::vector<uint32_t> TraceGraph::nodes_within(const glm::dvec3& position, double distance) const
{
    return index_.within(position, distance);
}

void TraceGraph::select(TraceSelection selection)
{
    const std::string reason = why_not(TraceSelectionChange{{}, selection}, true);
    SHVR_CHECK(reason.empty(), reason);
    selection_ = std::move(selection);
}

std::string TraceGraph::why_not(const TraceNodeChange& change, bool forwards) const
{
    const auto& [number, before, after] = change;
    const auto &from = forwards ? before : after, &to = forwards ? after : before;
    const auto found = nodes_.find(number);
    if (from ? found == nodes_.end() || found->second != *from : found != nodes_.end())
        return sentence("node ", number, " is not what the record says");
    if ((!from && !to) || (to && !is_valid(*to))) return sentence("node ", number, " has no place or radius");
    if (!to && !internodes_of(number).empty()) return sentence("node ", number, " still has internodes");
    return {};
}

std::string TraceGraph::why_not(const TraceInternodeChange& change, bool forwards) const
{
    const auto& [number, before, after] = change;
    const auto &from = forwards ? before : after, &to = forwards ? after : before;
    const auto found = internodes_.find(number);
    if (from ? found == internodes_.end() || found->second != *from : found != internodes_.end())
        return sentence("internode ", number, " is not what the record says");
    if (!from && !to) return sentence("internode ", number, " neither was nor will be");
    if (!to) return {};
    if (from && (from->a != to->a || from->b != to->b)) return sentence("internode ", number, " changes its nodes");
    if (to->a == to->b || !nodes_.contains(to->a) || !nodes_.contains(to->b))
        return sentence("internode ", number, " joins ", to->a, " and ", to->b);
    if (!from && internode_between(to->a, to->b))
        return sentence("internode ", number, " joins ", to->a, " and ", to->b, " again");
    return {};
}

std::string TraceGraph::why_not(const TraceSizeChange& change, bool forwards) const
{
    const auto &from = forwards ? change.before : change.after, &to = forwards ? change.after : change.before;
    const auto found = internode_radii_.find(change.group);
    const std::optional<double> now = found == internode_radii_.end() ? std::nullopt : std::optional(found->second);
    if (now == from && (!to || is_radius(*to))) return {};
    return sentence("the size of group ", int(change.group), " is not what the record says");
}

std::string TraceGraph::why_not(const TraceSelectionChange& change, bool forwards) const
{
    const TraceSelection& to = forwards ? change.after : change.before;
    for (const uint32_t number : to.nodes)
        if (!nodes_.contains(number)) return sentence("node ", number, " is to be selected and is not there");
    for (const uint32_t number : to.internodes)
        if (!internodes_.contains(number)) return sentence("internode ", number, " is to be selected and is not there");
    return {};
}

std::string TraceGraph::why_it_does_not_fit(const TraceChange& change, Direction direction) const
{
    return std::visit([&](const auto& record) { return why_not(record, direction == Direction::forwards); }, change);
}

void TraceGraph::set_node(uint32_t number, const std::optional<TraceNode>& from, const std::optional<TraceNode>& to)
{
    if (to) {
        next_node_ = std::max(next_node_, uint64_t{number} + 1);
        const bool moves = !from || from->position != to->position;
        if (moves) tally_.before_move(*this, number);
        nodes_[number] = *to;
        if (moves) tally_.after_move(*this, number);
        if (moves) index_.set(number, to->position);
        return;
    }
    nodes_.erase(number);
    index_.erase(number);
    if (holds(selection_.nodes, number)) selection_ = {};
}

void TraceGraph::set_internode(uint32_t number, const std::optional<TraceInternode>& from,
                               const std::optional<TraceInternode>& to)
{
    if (from && to) {
        tally_.change_group(*this, *from, *to);
        internodes_[number] = *to;
        return;
    }
    tally_.before_link(*this, from ? *from : *to, from.has_value());
    if (to) {
        internodes_[number] = *to;
        for (const uint32_t end : {to->a, to->b}) keep(internodes_of_[end], number);
        next_internode_ = std::max(next_internode_, uint64_t{number} + 1);
    } else {
        for (const uint32_t end : {from->a, from->b}) {
            std::vector<uint32_t>& of_end = internodes_of_[end];
            drop(of_end, number);
            if (of_end.empty()) internodes_of_.erase(end);
        }
        internodes_.erase(number);
        if (holds(selection_.internodes, number)) selection_ = {};
    }
    tally_.after_link(*this, to ? *to : *from, to.has_value());
}

void TraceGraph::apply(const TraceChange& change, Direction direction)
{
    const std::string reason = why_it_does_not_fit(change, direction);
    SHVR_CHECK(reason.empty(), reason);
    const bool forwards = direction == Direction::forwards;
    std::visit(
        [&](const auto& record) {
            using Record = std::decay_t<decltype(record)>;
            const auto& from = forwards ? record.before : record.after;
            const auto& to = forwards ? record.after : record.before;
            if constexpr (std::is_same_v<Record, TraceNodeChange>)
                set_node(record.node, from, to);
            else if constexpr (std::is_same_v<Record, TraceInternodeChange>)
                set_internode(record.internode, from, to);
            else if constexpr (std::is_same_v<Record, TraceSelectionChange>)
                selection_ = to;
            else if (to)
                internode_radii_[record.group] = *to;
            else
                internode_radii_.erase(record.group);
        },
        change);
    static std::atomic<uint64_t> revisions{0};
    revision_ = ++revisions;
}

bool operator==(const TraceGraph& left, const TraceGraph& right)
{
    return left.nodes_ == right.nodes_ && left.internodes_ == right.internodes_ &&
           left.internode_radii_ == right.internode_radii_;
}

}  // namespace shvr
