#include "engine/look/groups.h"

#include <array>

#include "engine/look/session_color.h"

namespace shvr {

namespace {

/// Default colours, none of them garish, found by the search in tests/unit/look/group_palette_test.cpp.
constexpr const char* GROUP_COLORS[] = {"#f36497", "#11a699", "#535bbf", "#648513", "#aca1ff",
                                        "#724e03", "#6fe2f2", "#185d41", "#614575", "#7380c7"};

/// Returns the decoded colours, which are cached, since every picture needs the looks of all groups.
const std::array<glm::dvec3, std::size(GROUP_COLORS)>& group_colors()
{
    static const auto colors = [] {
        std::array<glm::dvec3, std::size(GROUP_COLORS)> decoded{};
        for (size_t i = 0; i < decoded.size(); ++i) decoded[i] = glm::dvec3(color_of(GROUP_COLORS[i]).value());
        return decoded;
    }();
    return colors;
}

}  // namespace

ColorGroup default_group(uint8_t group)
{
    if (group == 0) return {.name = "unpainted", .opacity = 0.0};
    return {.name = "group " + std::to_string(group), .color = group_colors()[(group - 1u) % std::size(GROUP_COLORS)]};
}

uint8_t parent_of(const Groups& groups, uint8_t group)
{
    const auto found = groups.find(group);
    return found == groups.end() ? uint8_t{0} : found->second.parent;
}

ColorGroup group_of(const Groups& groups, uint8_t group)
{
    ColorGroup look = default_group(group);
    std::optional<glm::dvec3> color;
    std::optional<double> opacity;
    for (uint8_t at = group; at != 0; at = parent_of(groups, at)) {
        const auto found = groups.find(at);
        const GroupSettings settings = found == groups.end() ? GroupSettings{} : found->second;
        if (at == group && !settings.name.empty()) look.name = settings.name;
        // If no group up to the root states a colour, the root's default applies, one of the ten colours above.
        if (!color) color = settings.color;
        if (!color && settings.parent == 0) color = default_group(at).color;
        if (!opacity) opacity = settings.opacity;
        look.visible = look.visible && settings.visible;
    }
    look.color = color.value_or(look.color);
    look.opacity = opacity.value_or(look.opacity);
    return look;
}

bool is_locked(const Groups& groups, uint8_t group)
{
    for (; group != 0; group = parent_of(groups, group)) {
        const auto found = groups.find(group);
        if (found != groups.end() && found->second.locked) return true;
    }
    return false;
}

std::bitset<256> locked_groups(const Groups& groups)
{
    std::bitset<256> locked;
    for (const auto& [group, settings] : groups) locked[group] = is_locked(groups, group);
    return locked;
}

bool is_within(const Groups& groups, uint8_t group, uint8_t above)
{
    for (; group != 0; group = parent_of(groups, group))
        if (group == above) return true;
    return false;
}

std::optional<uint8_t> group_in_cycle(const Groups& groups)
{
    for (const auto& [group, settings] : groups) {
        uint8_t at = settings.parent;
        for (size_t steps = 0; at != 0 && at != group && steps < groups.size(); ++steps) at = parent_of(groups, at);
        if (at == group) return group;
    }
    return std::nullopt;
}

}  // namespace shvr
