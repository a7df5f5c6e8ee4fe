#pragma once
// The colour groups as a tree to look at, to search and to rearrange. Pure; any thread.

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
    bool is_found = true;  ///< false: only there for the sake of those below it, which are found
};
/// Groups that have a key, are described, are painted or traced, or are chosen; each below its parent. `search`: a part
/// of the name, whatever its case, or a number; empty: all.
std::vector<GroupRow> listed_groups(const Groups& groups, const std::array<int64_t, 256>& voxels,
                                    std::span<const uint8_t> traced, uint8_t chosen, const std::string& search = {});
/// "3  leaf trace"; "0  unpainted".
std::string label_of_group(const Groups& groups, uint8_t group);

/// The smallest number that nothing uses; 0 where all are used.
uint8_t free_group(const Groups& groups, const std::array<int64_t, 256>& voxels, std::span<const uint8_t> traced);

/// Why a group may not be put below another (0: below none); empty: it may.
std::string why_not_below(const Groups& groups, uint8_t group, uint8_t parent);

/// What a trace has in a group. Radii are means, in physical units.
struct TracedGroup {
    size_t nodes = 0, internodes = 0;
    double node_radius = 0.0, internode_radius = 0.0;
    bool tapers = true;  ///< internodes from node to node; false: all have one radius
};
std::array<TracedGroup, 256> traced_groups(const TraceGraph& trace);
/// Those that have a node or an internode.
std::vector<uint8_t> groups_in(const std::array<TracedGroup, 256>& traced);

/// Those that a picture shows: painted or traced, and neither hidden, nor left out by `view.solo`, nor clear.
std::vector<uint8_t> drawn_groups(const Session& session, const std::array<int64_t, 256>& voxels,
                                  const TraceGraph& trace);

/// 1234567 as "1,234,567"
std::string with_separators(int64_t count);

}  // namespace shvr::ui
