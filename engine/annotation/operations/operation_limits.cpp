#include "engine/annotation/operations/operation_limits.h"

#include <algorithm>

#include "engine/base/text.h"
#include "engine/volume/grid.h"

namespace shvr {

glm::dvec4 plane_in_voxels(const OperationLimits& limits, const glm::dvec3& spacing)
{
    if (!limits.plane_normal || !limits.plane_point) return glm::dvec4(0.0);
    const glm::dvec3 along = glm::normalize(*limits.plane_normal) * spacing;
    return {along, -glm::dot(along, *limits.plane_point)};
}

VoxelBox read_box(const JsonNode& node)
{
    constexpr const char* EXPECTED = "six whole numbers, [x0,y0,z0,x1,y1,z1], with x0 < x1, y0 < y1 and z0 < z1";
    if (node.count() != 6) node.refuse(EXPECTED);
    const std::vector<JsonNode> elements = node.elements();
    const auto corner = [&](size_t first) {
        Size3 voxel(0);
        for (size_t axis = 0; axis < 3; ++axis) voxel[int(axis)] = elements[first + axis].whole(-MAX_SIDE, MAX_SIDE);
        return voxel;
    };
    const VoxelBox box{corner(0), corner(3)};
    if (!glm::all(glm::lessThan(box.lower, box.upper))) node.refuse(EXPECTED);
    return box;
}

std::string text_of(const VoxelBox& box)
{
    return sentence('[', box.lower.x, ',', box.lower.y, ',', box.lower.z, ',', box.upper.x, ',', box.upper.y, ',',
                    box.upper.z, ']');
}

std::vector<uint8_t> read_groups(const JsonNode& node)
{
    if (node.count() == 0) node.refuse("an array of groups, 1 ... 255, such as [1, 2]");
    std::vector<uint8_t> groups;
    for (const JsonNode& element : node.elements()) {
        const auto group = uint8_t(element.whole(1, 255));
        if (std::ranges::find(groups, group) != groups.end()) element.refuse("each group once");
        groups.push_back(group);
    }
    return groups;
}

std::string text_of(std::span<const uint8_t> groups)
{
    std::string text;
    for (const uint8_t group : groups) text += sentence(text.empty() ? "[" : ",", int(group));
    return text + "]";
}

glm::dvec2 read_range(const JsonNode& node)
{
    if (node.count() != 2) node.refuse("two numbers, [low, high]");
    const std::vector<JsonNode> elements = node.elements();
    const glm::dvec2 range(elements[0].number(any_number()), elements[1].number(any_number()));
    if (range.x > range.y) node.refuse("[low, high], the lower one first");
    return range;
}

std::string text_of(const glm::dvec2& range)
{
    return sentence('[', digits_of(range.x), ',', digits_of(range.y), ']');
}

}  // namespace shvr
