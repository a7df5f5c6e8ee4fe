#include "engine/look/cut_corners.h"

namespace shvr {

std::vector<glm::dvec3> corners_left(const glm::dvec3& lower, const glm::dvec3& upper, const glm::dvec4& plane)
{
    std::vector<glm::dvec3> corners;
    if (glm::any(glm::greaterThan(lower, upper))) return corners;
    const auto corner = [&](int i) { return glm::mix(lower, upper, glm::bvec3(i & 1, i & 2, i & 4)); };
    const auto beyond = [&](int i) { return glm::dot(plane, glm::dvec4(corner(i), 1.0)); };
    for (int i = 0; i < 8; ++i) {
        const double from = beyond(i);
        if (from <= 0.0) corners.push_back(corner(i));
        for (const int axis : {1, 2, 4}) {  // edges that the plane crosses
            const double to = beyond(i | axis);
            if (!(i & axis) && (from > 0.0) != (to > 0.0))
                corners.push_back(glm::mix(corner(i), corner(i | axis), from / (from - to)));
        }
    }
    return corners;
}

std::vector<glm::dvec3> corners_left(const CutBox& cut, const VolumeInfo& volume)
{
    const glm::dvec3 size(volume.size);
    return corners_left(glm::max(cut.lower, glm::dvec3(0.0)), glm::min(cut.upper, size),
                        plane_in_voxels(cut, volume.size, volume.spacing));
}

std::optional<std::pair<glm::dvec3, glm::dvec3>> box_left(const CutBox& cut, const VolumeInfo& volume)
{
    const std::vector<glm::dvec3> corners = corners_left(cut, volume);
    if (corners.empty()) return std::nullopt;
    std::pair box(corners[0], corners[0]);
    for (const glm::dvec3& corner : corners) box = {glm::min(box.first, corner), glm::max(box.second, corner)};
    return box;
}

}  // namespace shvr
