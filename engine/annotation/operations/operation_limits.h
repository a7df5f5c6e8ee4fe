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
};

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
}

}  // namespace shvr
