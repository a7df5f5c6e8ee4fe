#pragma once
// Colour groups override the transfer function where voxels are painted. They form a tree: a group inherits from its
// parent each setting that it lacks, and hiding or locking a group also affects all its descendants. Changing a group's
// settings changes no voxel.

#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

namespace shvr {

/// A user's settings for a group.
struct GroupSettings {
    std::string name;                 ///< empty: "group N"
    uint8_t parent = 0;               ///< 0: none
    std::optional<glm::dvec3> color;  ///< linear light; default: the parent's, or a palette colour for a root
    std::optional<double> opacity;    ///< per reference length; default: the parent's; for a root: 1
    bool visible = true;              ///< false: its voxels and those of its descendants are hidden
    bool locked = false;              ///< true: brushes change neither its voxels nor its descendants' voxels
    bool operator==(const GroupSettings&) const = default;
};
using Groups = std::map<uint8_t, GroupSettings>;  ///< keys 1 ... 255; a group without an entry has default settings

/// The effective look of a group.
struct ColorGroup {
    std::string name;
    glm::dvec3 color{1.0};
    double opacity = 1.0;
    bool visible = true;
    bool operator==(const ColorGroup&) const = default;
};

/// The minimum CIEDE2000 difference between any two of the ten colours, and between them and the default transfer
/// function or white; in normal vision and simulated protanopia, deuteranopia and tritanopia (Machado 2009).
inline constexpr double MIN_GROUP_DIFFERENCE = 12.3;
/// Returns the default look, in one of ten distinguishable colours, which repeat. Group 0 (unpainted) is transparent.
ColorGroup default_group(uint8_t group);
ColorGroup group_of(const Groups& groups, uint8_t group);

/// Whether the group or one of its ancestors is locked.
bool is_locked(const Groups& groups, uint8_t group);
/// Returns `is_locked` for every group; element 0 (unpainted voxels) is never set.
std::bitset<256> locked_groups(const Groups& groups);

/// Returns the parent; 0 if the group has none.
uint8_t parent_of(const Groups& groups, uint8_t group);
/// Whether `group` is `above` or a descendant of it. If so, `group` must not become the parent of `above`.
bool is_within(const Groups& groups, uint8_t group, uint8_t above);
/// Returns a group that is its own ancestor, if there is one. The other functions require groups without cycles.
std::optional<uint8_t> group_in_cycle(const Groups& groups);

}  // namespace shvr
