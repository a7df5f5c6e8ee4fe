#include "engine/workbench/sight/cut_handles.h"

#include <algorithm>
#include <cmath>

namespace shvr::ui {

namespace {

/// Least angle, as a sine, between a handle's axis and the line of sight.
constexpr double MIN_SINE = 0.1;
/// Voxels that remain visible when one face is dragged towards the other one.
constexpr double MIN_THICKNESS = 1.0;
/// Least distance in pixels at which the handles of two faces can be told apart.
constexpr double MIN_APART = 0.5 * HANDLE_PIXELS;

struct Corners {
    glm::dvec3 lower, upper;
};

Corners corners_of(const CutBox& cut, const VolumeInfo& volume)
{
    const glm::dvec3 size(volume.size), lower = glm::clamp(cut.lower, glm::dvec3(0.0), size);
    return {lower, glm::clamp(cut.upper, lower, size)};
}

glm::dvec3 unit_vector(int axis)
{
    glm::dvec3 along(0.0);
    along[axis] = 1.0;
    return along;
}

struct Sight {
    glm::dvec3 from, along;  ///< a point on the line of sight, and its direction as a unit vector
};

Sight sight_through(const Pane& pane, const glm::dvec2& pixel)
{
    const Camera& camera = pane.shot.camera;
    const double reach = glm::distance(camera.eye, camera.target);
    const glm::dvec3 near = unproject(camera, pane.pixels(), pixel, 0.5 * reach);
    return {near, glm::normalize(unproject(camera, pane.pixels(), pixel, 1.5 * reach) - near)};
}

}  // namespace

std::optional<double> place_along(const Pane& pane, const glm::dvec3& origin, const glm::dvec3& along,
                                  const glm::dvec2& pixel)
{
    const Sight sight = sight_through(pane, pixel);
    const double cosine = glm::dot(sight.along, along), square = 1.0 - cosine * cosine;
    if (square < MIN_SINE * MIN_SINE) return std::nullopt;
    const glm::dvec3 between = sight.from - origin;
    return (glm::dot(between, along) - cosine * glm::dot(between, sight.along)) / square;
}

std::vector<CutHandle> cut_handles(const Pane& pane, const CutBox& cut, const VolumeInfo& volume)
{
    std::vector<CutHandle> handles;
    if (pane.kind == Pane::Kind::map || pane.shot.right_eye) return handles;
    const Corners box = corners_of(cut, volume);
    for (int axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true}) {
            CutHandle handle{.axis = axis, .upper = upper, .voxel = upper ? box.upper[axis] : box.lower[axis]};
            glm::dvec3 voxel = 0.5 * (box.lower + box.upper);
            voxel[axis] = handle.voxel;
            handle.middle = voxel * volume.spacing;
            const auto seen = project(pane.shot.camera, pane.pixels(), handle.middle);
            if (!seen || !place_along(pane, handle.middle, unit_vector(axis), seen->pixel)) continue;
            handle.at = seen->pixel;
            const bool coincide = upper && !handles.empty() && handles.back().axis == axis &&
                                  glm::distance(handles.back().at, handle.at) < MIN_APART;
            if (!coincide)
                handles.push_back(handle);
            else if (double(volume.size[axis]) - box.upper[axis] > box.lower[axis])
                handles.back() = handle;
        }
    return handles;
}

CutBox dragged(const CutBox& cut, const CutHandle& handle, const Pane& pane, const VolumeInfo& volume,
               const glm::dvec2& from, const glm::dvec2& to)
{
    const int axis = handle.axis;
    const glm::dvec3 along = unit_vector(axis);
    const auto begin = place_along(pane, handle.middle, along, from), end = place_along(pane, handle.middle, along, to);
    if (!begin || !end) return cut;
    const Corners box = corners_of(cut, volume);
    const double voxel = handle.voxel + (*end - *begin) / volume.spacing[axis], size(double(volume.size[axis]));
    CutBox moved = cut;
    if (handle.upper)
        moved.upper[axis] = std::clamp(voxel, std::min(box.lower[axis] + MIN_THICKNESS, size), size);
    else
        moved.lower[axis] = std::clamp(voxel, 0.0, std::max(box.upper[axis] - MIN_THICKNESS, 0.0));
    return moved;
}

std::vector<glm::dvec2> box_in_slice(const Pane& pane, const CutBox& cut, const VolumeInfo& volume)
{
    const Corners box = corners_of(cut, volume);
    const int second = (pane.axis + 1) % 3, third = (pane.axis + 2) % 3;
    std::vector<glm::dvec2> corners;
    for (const int corner : {0, 1, 3, 2}) {
        glm::dvec3 voxel = box.lower;
        if (corner & 1) voxel[second] = box.upper[second];
        if (corner & 2) voxel[third] = box.upper[third];
        const auto seen = project(pane.shot.camera, pane.pixels(), voxel * volume.spacing);
        if (!seen) return {};
        corners.push_back(seen->pixel);
    }
    return corners;
}

}  // namespace shvr::ui
