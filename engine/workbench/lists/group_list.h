#pragma once
// The colour groups as a tree to display, search and rearrange. Pure; any thread.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/look/groups.h"
#include "engine/session/session.h"

namespace shvr::ui {

inline constexpr uint8_t GROUPS_WITH_KEYS = 9;

struct GroupRow {
    uint8_t group = 0;
    int depth = 0;         ///< below the groups without a parent
    bool is_found = true;  ///< false: does not match, and is listed only as an ancestor of a matching group
};
/// Returns the groups that have a key, are described, painted, traced or active, each below its parent. `search`: part
/// of a name, ignoring case, or a number; empty: all groups.
std::vector<GroupRow> listed_groups(const Groups& groups, const std::array<int64_t, 256>& voxels,
                                    std::span<const uint8_t> traced, uint8_t chosen, const std::string& search = {});
/// Returns "3  leaf trace"; "0  unpainted".
std::string label_of_group(const Groups& groups, uint8_t group);

/// Returns the smallest unused group number; 0 if all are used.
uint8_t free_group(const Groups& groups, const std::array<int64_t, 256>& voxels, std::span<const uint8_t> traced);

/// Returns why a group cannot become a child of `parent` (0: top level); empty if it can.
std::string why_not_below(const Groups& groups, uint8_t group, uint8_t parent);

/// Statistics of those nodes and internodes of a trace that are in a group. Radii are means, in physical units.
struct TracedGroup {
    size_t nodes = 0, internodes = 0;
    double node_radius = 0.0, internode_radius = 0.0;
    bool tapers = true;  ///< internodes taper from node to node; false: all have the same radius
};
std::array<TracedGroup, 256> traced_groups(const TraceGraph& trace);
/// Returns the groups that have a node or an internode.
std::vector<uint8_t> groups_in(const std::array<TracedGroup, 256>& traced);

/// Returns the groups visible in pictures: painted or traced, and not hidden, transparent or excluded by `view.solo`.
std::vector<uint8_t> drawn_groups(const Session& session, const std::array<int64_t, 256>& voxels,
                                  const TraceGraph& trace);

}  // namespace shvr::ui
