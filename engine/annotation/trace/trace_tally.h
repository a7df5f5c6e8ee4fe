#pragma once
// Running totals of a trace, updated with each change: lengths by group, and the number
// of segments. So totals are known at any time without a visit to the whole trace. A
// change costs as much as visiting the internodes of the changed nodes; a change that
// splits or joins segments costs about as much as visiting the shorter of the two
// segments.

#include <cstddef>
#include <cstdint>
#include <map>

namespace shvr {

struct TraceNode;
struct TraceInternode;
class TraceGraph;

/// Summary of a trace for a panel.
struct TraceSummary {
    size_t nodes = 0, internodes = 0;
    size_t segments = 0;                     ///< equals the number found by segments_of
    double length = 0.0;                     ///< total of all internodes, in the volume's unit
    std::map<uint8_t, double> group_length;  ///< by the internodes' groups
};

class TraceTally {
public:
    /// Call before and after changing the position of `node`.
    void before_move(const TraceGraph& trace, uint32_t node);
    void after_move(const TraceGraph& trace, uint32_t node);
    /// Call before and after adding or removing an internode. `is_there`: whether it is in the trace at that time.
    void before_link(const TraceGraph& trace, const TraceInternode& internode, bool is_there);
    void after_link(const TraceGraph& trace, const TraceInternode& internode, bool is_there);
    void change_group(const TraceGraph& trace, const TraceInternode& from, const TraceInternode& to);

    TraceSummary summary_of(const TraceGraph& trace) const;
    /// An upper bound of the lengths of internodes: a power of two, at most twice the longest length; 0: no internodes.
    double longest_at_most() const;

private:
    /// A sum with twice the precision of a double, so that adding a value and subtracting it again leaves no remainder.
    struct LongSum {
        double high = 0.0, low = 0.0;
        void add(double value);
        double value() const { return high + low; }
    };
    struct Group {
        size_t internodes = 0;
        LongSum length;
    };
    void add_length(const TraceGraph& trace, const TraceInternode& internode);
    void remove_length(const TraceGraph& trace, const TraceInternode& internode);

    std::map<uint8_t, Group> groups_;  ///< groups that have internodes
    std::map<int, size_t> lengths_;    ///< number of internodes, by binary exponent of their lengths
    size_t inner_nodes_ = 0;           ///< nodes with exactly two internodes, where no segment ends
    size_t closed_segments_ = 0;       ///< loops made of such nodes only
};

}  // namespace shvr
