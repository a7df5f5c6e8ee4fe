#include "engine/workbench/sight/outlines.h"

#include <algorithm>
#include <limits>

#include "engine/look/cut_corners.h"

namespace shvr::ui {

namespace {

/// Distance from the eye, along the line of sight, at which the part of the volume that the cutting planes leave
/// begins; 0 if they leave nothing.
double front_of(const Camera& camera, const CutBox& cut, const VolumeInfo& volume)
{
    const std::vector<glm::dvec3> corners = corners_left(cut, volume);
    const glm::dvec3 forward = axes_of(camera).forward;
    double front = corners.empty() ? 0.0 : std::numeric_limits<double>::infinity();
    for (const glm::dvec3& corner : corners)
        front = std::min(front, glm::dot(corner * volume.spacing - camera.eye, forward));
    return camera.projection == Camera::Projection::perspective ? std::max(front, camera.near_distance) : front;
}

}  // namespace

std::vector<glm::dvec2> rectangle_of(const glm::dvec2& from, const glm::dvec2& to)
{
    return {from, {to.x, from.y}, to, {from.x, to.y}};
}

void set_outline(LassoOp& op, const Pane& pane, std::span<const glm::dvec2> drawn, std::optional<double> depth,
                 const CutBox& cut, const VolumeInfo& volume)
{
    const Camera& camera = pane.shot.camera;
    const CameraAxes axes = axes_of(camera);
    const bool is_perspective = camera.projection == Camera::Projection::perspective;
    const glm::dvec3 from = pane.shot.is_slice ? camera.target : camera.eye;  // the target lies in the slice
    op.view = {.projection = is_perspective ? LassoView::Projection::perspective : LassoView::Projection::orthographic,
               .eye = from,
               .target = from + axes.forward * glm::distance(camera.eye, camera.target),
               .up = camera.up};
    op.polygon.clear();
    for (const glm::dvec2& pixel : drawn) {
        const glm::dvec3 way = unproject(camera, pane.pixels(), pixel, 1.0) - from;
        op.polygon.emplace_back(glm::dot(way, axes.right), glm::dot(way, axes.up));
    }
    op.depth.reset();
    if (!depth) return;
    const double nearest = pane.shot.is_slice ? -0.5 * *depth : front_of(camera, cut, volume);
    op.depth = glm::dvec2(nearest, nearest + *depth);
}

}  // namespace shvr::ui
