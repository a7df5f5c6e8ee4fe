#include "engine/workbench/edits/group_steps.h"

#include <algorithm>
#include <set>

namespace shvr::ui {

namespace {

constexpr uint8_t KEYED_GROUPS = 9;

std::set<uint8_t> used_groups(const Model& model)
{
    std::set<uint8_t> groups;
    for (const auto& [group, settings] : model.session.groups) groups.insert({group, settings.parent});
    for (size_t group = 1; group < model.voxels_by_group.size(); ++group)
        if (model.voxels_by_group[group] > 0) groups.insert(uint8_t(group));
    for (const auto& [number, node] : model.trace.nodes()) groups.insert(node.group);
    for (const auto& [number, internode] : model.trace.internodes()) groups.insert(internode.group);
    return groups;
}

}  // namespace

std::vector<uint8_t> known_groups(const Model& model)
{
    std::set<uint8_t> groups = used_groups(model);
    for (uint8_t group = 1; group <= KEYED_GROUPS; ++group) groups.insert(group);
    groups.insert(model.brush().group);
    groups.erase(0);
    return {groups.begin(), groups.end()};
}

uint8_t next_group(const Model& model, int direction)
{
    const std::vector<uint8_t> groups = known_groups(model);
    const uint8_t active = model.brush().group;
    if (direction > 0) {
        const auto above = std::ranges::upper_bound(groups, active);
        return above == groups.end() ? groups.front() : *above;
    }
    const auto at = std::ranges::lower_bound(groups, active);
    return at == groups.begin() ? groups.back() : *(at - 1);
}

uint8_t unused_group(const Model& model)
{
    const std::set<uint8_t> used = used_groups(model);
    for (int group = 1; group <= 255; ++group)
        if (!used.contains(uint8_t(group))) return uint8_t(group);
    return 0;
}

}  // namespace shvr::ui
