#pragma once
// Limits of an operation: they restrict which voxels may change, not which voxels the operation reads. So growing in a
// box also starts from the group's voxels outside it. Locks of groups come from the session (MaskEdit).

#include <functional>
#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "engine/base/json.h"
#include "engine/volume/volume.h"

namespace shvr {

struct OperationLimits {
    std::optional<glm::dvec2> within{};  ///< only voxels with intensities in this range, both ends inclusive
    std::optional<int64_t> inside{};     ///< only voxels of this group; 0: unpainted ones
    bool only_unpainted = false;         ///< only unpainted voxels, so no group loses voxels
    std::optional<VoxelBox> box{};       ///< only voxels in this box; null: in the whole volume
    /// Only voxels with centres on this plane or behind it: a direction in physical space, towards voxels that do not
    /// change, and a point on the plane, in voxels. Both or neither; as cut.plane_normal and cut.plane_point.
    std::optional<glm::dvec3> plane_normal{}, plane_point{};
};

/// The plane as dot(xyz, voxel) + w, which is positive where voxels do not change; 0 everywhere if there is none.
glm::dvec4 plane_in_voxels(const OperationLimits& limits, const glm::dvec3& spacing);

/// Reads "[x0,y0,z0,x1,y1,z1]", a half-open box in voxels; refuses a box without voxels.
VoxelBox read_box(const JsonNode& node);
std::string text_of(const VoxelBox& box);
/// Reads an array of group numbers from 1 to 255; refuses duplicates.
std::vector<uint8_t> read_groups(const JsonNode& node);
std::string text_of(std::span<const uint8_t> groups);
/// Reads "[low, high]".
glm::dvec2 read_range(const JsonNode& node);
std::string text_of(const glm::dvec2& range);

/// `f`: engine/session/fields.h
template <class Fields>
void box_field(Fields& f, std::optional<VoxelBox>& box)
{
    f.other(
        "box", [&](const JsonNode& node) { box = read_box(node); },
        [&] { return box ? std::optional(text_of(*box)) : std::nullopt; },
        {"changes only voxels of this box: [x0,y0,z0,x1,y1,z1], half-open"});
}

template <class Fields>
void limit_fields(Fields& f, OperationLimits& limits)
{
    f.other(
        "within", [&](const JsonNode& node) { limits.within = read_range(node); },
        [&] { return limits.within ? std::optional(text_of(*limits.within)) : std::nullopt; },
        {"changes only voxels of these intensities: [low, high], inclusive"});
    f.any_whole("inside", limits.inside, 0, 255, {"changes only voxels of this group; 0: unpainted ones"});
    f.flag("only_unpainted", limits.only_unpainted, {"changes only unpainted voxels"});
    box_field(f, limits.box);
    f.vector("plane_normal", limits.plane_normal, {-1e6, 1e6},
             {"changes only voxels behind a plane: direction towards the others, as in cut.plane_normal"});
    f.vector("plane_point", limits.plane_point, {-1e6, 1e6}, {"point on that plane", "voxels"});
    f.check("plane_normal", !limits.plane_normal || glm::length(*limits.plane_normal) >= 1e-6,
            "a direction of a length from 1e-6");
    f.check("plane_point", limits.plane_normal.has_value() == limits.plane_point.has_value(),
            "both plane_normal and plane_point, or neither");
}

}  // namespace shvr
