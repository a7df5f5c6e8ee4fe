#include "engine/workbench/lists/group_list.h"

#include <algorithm>
#include <bitset>
#include <cctype>
#include <set>

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

std::string lowered(std::string text)
{
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return text;
}

bool is_found(const Groups& groups, uint8_t group, const std::string& search)
{
    if (search.empty()) return true;
    const bool is_number = std::ranges::all_of(search, [](char c) { return c >= '0' && c <= '9'; });
    if (is_number && std::to_string(group) == search) return true;
    return lowered(label_of_group(groups, group)).find(lowered(search)) != std::string::npos;
}

}  // namespace

std::vector<GroupRow> listed_groups(const Groups& groups, const std::array<int64_t, 256>& voxels,
                                    std::span<const uint8_t> traced, uint8_t chosen, const std::string& search)
{
    std::set<uint8_t> listed{chosen};
    listed.insert(traced.begin(), traced.end());
    for (uint8_t group = 0; group <= GROUPS_WITH_KEYS; ++group) listed.insert(group);
    for (const auto& [group, settings] : groups) listed.insert({group, settings.parent});
    for (size_t group = 1; group < voxels.size(); ++group)
        if (voxels[group] > 0) listed.insert(uint8_t(group));
    std::vector<GroupRow> rows;
    // Adds a row for the group if the group or one of its descendants matches the search. Returns whether it did.
    const auto add = [&](const auto& self, uint8_t group, int depth) -> bool {
        const size_t at = rows.size();
        rows.push_back({group, depth, is_found(groups, group, search)});
        bool is_any_found = rows.back().is_found;
        for (const uint8_t child : listed)
            if (group != 0 && parent_of(groups, child) == group)
                is_any_found = self(self, child, depth + 1) || is_any_found;
        if (!is_any_found) rows.resize(at);
        return is_any_found;
    };
    for (const uint8_t group : listed)
        if (parent_of(groups, group) == 0) add(add, group, 0);
    return rows;
}

std::string label_of_group(const Groups& groups, uint8_t group)
{
    return std::to_string(group) + "  " + group_of(groups, group).name;
}

uint8_t free_group(const Groups& groups, const std::array<int64_t, 256>& voxels, std::span<const uint8_t> traced)
{
    for (int group = 1; group < 256; ++group) {
        const bool is_traced = std::ranges::find(traced, uint8_t(group)) != traced.end();
        if (!groups.contains(uint8_t(group)) && voxels[size_t(group)] == 0 && !is_traced) return uint8_t(group);
    }
    return 0;
}

std::string why_not_below(const Groups& groups, uint8_t group, uint8_t parent)
{
    if (group == 0) return "what is unpainted is no group";
    if (parent == group) return "a group cannot be below itself";
    if (parent != 0 && is_within(groups, parent, group))
        return sentence("group ", int{parent}, " is below group ", int{group});
    if (parent_of(groups, group) == parent) return parent == 0 ? "it is below none" : "it is there already";
    return {};
}

std::array<TracedGroup, 256> traced_groups(const TraceGraph& trace)
{
    std::array<TracedGroup, 256> groups{};
    for (const auto& [number, node] : trace.nodes()) {
        ++groups[node.group].nodes;
        groups[node.group].node_radius += node.radius;
    }
    for (const auto& [number, internode] : trace.internodes()) {
        ++groups[internode.group].internodes;
        groups[internode.group].internode_radius += trace.radius_of(internode, 0.5);
    }
    for (size_t group = 0; group < groups.size(); ++group) {
        TracedGroup& each = groups[group];
        each.tapers = !trace.internode_radii().contains(uint8_t(group));
        if (each.nodes > 0) each.node_radius /= double(each.nodes);
        if (each.internodes > 0) each.internode_radius /= double(each.internodes);
    }
    return groups;
}

std::vector<uint8_t> groups_in(const std::array<TracedGroup, 256>& traced)
{
    std::vector<uint8_t> groups;
    for (size_t group = 1; group < traced.size(); ++group)
        if (traced[group].nodes + traced[group].internodes > 0) groups.push_back(uint8_t(group));
    return groups;
}

std::vector<uint8_t> drawn_groups(const Session& session, const std::array<int64_t, 256>& voxels,
                                  const TraceGraph& trace)
{
    std::bitset<256> traced;
    if (session.view.meshes) {
        for (const auto& [number, node] : trace.nodes()) traced.set(node.group);
        for (const auto& [number, internode] : trace.internodes()) traced.set(internode.group);
    }
    const std::optional<uint8_t> solo = session.view.solo;
    std::vector<uint8_t> drawn;
    for (size_t each = 1; each < voxels.size(); ++each) {
        const auto group = uint8_t(each);
        const ColorGroup look = group_of(session.groups, group);
        const bool shows_paint = voxels[each] > 0 && session.view.volume && look.opacity > 0.0;
        if (!look.visible || (!shows_paint && !traced.test(each))) continue;
        if (!solo || (*solo != 0 && is_within(session.groups, group, *solo))) drawn.push_back(group);
    }
    return drawn;
}

}  // namespace shvr::ui
