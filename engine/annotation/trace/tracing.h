#pragma once
// The trace: a graph of nodes along the centre lines of tubes, and of internodes, each of which joins two nodes. Loops
// are allowed, but no internode may join a node with itself, or two nodes that are joined already. Positions and radii
// are in volume space (physical, the volume's unit). Like the mask, the trace changes only through records of exact
// values before and after. The selection is not annotation and needs no record, but commands may contain one.
//
// Numbers of nodes and internodes are never reused, not even after an undo.
//
// One thread, the main one, owns a trace and lends it as const. A copy shares storage with the original (shared_map.h),
// so copying is cheap; a copy may be used on another thread.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "engine/annotation/direction.h"
#include "engine/annotation/trace/shared_map.h"
#include "engine/annotation/trace/trace_index.h"
#include "engine/annotation/trace/trace_tally.h"

namespace shvr {

struct TraceNode {
    glm::dvec3 position{0.0};  ///< volume space
    double radius = 1.0;       ///< the volume's unit, 0 or more
    uint8_t group = 1;
    bool operator==(const TraceNode&) const = default;
};

struct TraceInternode {
    uint32_t a = 0, b = 0;  ///< its nodes
    uint8_t group = 1;
    bool operator==(const TraceInternode&) const = default;
    uint32_t other(uint32_t node) const { return node == a ? b : a; }
};

/// One node, one internode, or all nodes and internodes of a segment; in ascending order.
struct TraceSelection {
    std::vector<uint32_t> nodes, internodes;
    bool operator==(const TraceSelection&) const = default;
    bool empty() const { return nodes.empty() && internodes.empty(); }
    /// The selected node, if nothing else is selected; otherwise null.
    std::optional<uint32_t> node() const;
    std::optional<uint32_t> internode() const;
};

/// Adds (`before` is null), removes (`after` is null) or changes a node.
struct TraceNodeChange {
    uint32_t node = 0;
    std::optional<TraceNode> before, after;
    bool operator==(const TraceNodeChange&) const = default;
};
/// Adds, removes or changes an internode, like TraceNodeChange. A change must keep the internode's two nodes.
struct TraceInternodeChange {
    uint32_t internode = 0;
    std::optional<TraceInternode> before, after;
    bool operator==(const TraceInternodeChange&) const = default;
};
/// Changes the radius of all internodes of a group; null: their radius tapers from node to node.
struct TraceSizeChange {
    uint8_t group = 0;
    std::optional<double> before, after;
    bool operator==(const TraceSizeChange&) const = default;
};
/// Replaces the selection, whatever it was. A command that changes the selection begins with a record whose `after` is
/// empty and ends with a record whose `before` is empty, so that redo and undo never select missing objects.
struct TraceSelectionChange {
    TraceSelection before, after;
    bool operator==(const TraceSelectionChange&) const = default;
};
using TraceChange = std::variant<TraceNodeChange, TraceInternodeChange, TraceSizeChange, TraceSelectionChange>;

class TraceGraph {
public:
    const SharedMap<TraceNode>& nodes() const { return nodes_; }
    const SharedMap<TraceInternode>& internodes() const { return internodes_; }
    const std::map<uint8_t, double>& internode_radii() const { return internode_radii_; }
    const TraceNode& node(uint32_t number) const;
    const TraceInternode& internode(uint32_t number) const;
    /// Ascending; empty for an isolated node.
    std::span<const uint32_t> internodes_of(uint32_t node) const;
    std::optional<uint32_t> internode_between(uint32_t a, uint32_t b) const;
    double length_of(const TraceInternode& internode) const;
    /// The radius at the fraction `t` (0 ... 1) of the way from node a to node b.
    double radius_of(const TraceInternode& internode, double t) const;

    /// The number that the next node (or internode) will get; larger than any number used so far.
    uint64_t next_node() const { return next_node_; }
    uint64_t next_internode() const { return next_internode_; }
    /// Reserves all numbers below these. Files state the two numbers, because deleted objects may have had higher ones.
    void reserve_numbers(uint64_t next_node, uint64_t next_internode);

    /// The node nearest to a position; in a tie, the node with the smallest number; null if there are no nodes.
    std::optional<uint32_t> nearest_node(const glm::dvec3& position, std::optional<uint32_t> except = {}) const;

    /// All nodes within `distance`, ascending.
    std::vector<uint32_t> nodes_within(const glm::dvec3& position, double distance) const;
    /// An upper bound of all internodes' lengths, at most twice the longest one; 0 without internodes.
    double longest_at_most() const { return tally_.longest_at_most(); }

    /// Numbers of nodes, internodes and segments, and lengths. They are kept up to date, so this call is cheap.
    TraceSummary summary() const { return tally_.summary_of(*this); }

    /// A number that changes with each record that is applied, also in copies; equal numbers mean equal traces.
    uint64_t revision() const { return revision_; }

    const TraceSelection& selection() const { return selection_; }
    /// The selected objects must exist (SHVR_CHECK).
    void select(TraceSelection selection);

    /// Returns why a record cannot be applied; empty if it can. The trace must match the record's values before the
    /// change, a removed node must have no internodes, an added internode must join two existing nodes that are not
    /// joined yet, and selected objects must exist.
    std::string why_it_does_not_fit(const TraceChange& change, Direction direction) const;
    /// Applies a record that fits (SHVR_CHECK). Deselects removed objects.
    void apply(const TraceChange& change, Direction direction);

    /// Compares nodes, internodes and radii, but not the selection or the next numbers.
    friend bool operator==(const TraceGraph& left, const TraceGraph& right);

private:
    std::string why_not(const TraceNodeChange& change, bool forwards) const;
    std::string why_not(const TraceInternodeChange& change, bool forwards) const;
    std::string why_not(const TraceSizeChange& change, bool forwards) const;
    std::string why_not(const TraceSelectionChange& change, bool forwards) const;
    void set_node(uint32_t number, const std::optional<TraceNode>& from, const std::optional<TraceNode>& to);
    void set_internode(uint32_t number, const std::optional<TraceInternode>& from,
                       const std::optional<TraceInternode>& to);

    SharedMap<TraceNode> nodes_;
    SharedMap<TraceInternode> internodes_;
    SharedMap<std::vector<uint32_t>> internodes_of_;  ///< for nodes that have any
    std::map<uint8_t, double> internode_radii_;
    uint64_t next_node_ = 0, next_internode_ = 0;  ///< 2^32: none left
    uint64_t revision_ = 0;                        ///< 0: empty
    TraceSelection selection_;
    TraceIndex index_;
    TraceTally tally_;
};

}  // namespace shvr
