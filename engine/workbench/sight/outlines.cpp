#include "engine/workbench/sight/outlines.h"

#include <algorithm>
#include <limits>

namespace shvr::ui {

namespace {

/// Distance from the eye, along the line of sight, at which the part of the volume within the cutting planes begins.
double front_of(const Camera& camera, const CutBox& cut, const VolumeInfo& volume)
{
    const glm::dvec3 lower = glm::max(cut.lower, glm::dvec3(0.0)), upper = glm::min(cut.upper, glm::dvec3(volume.size)),
                     forward = axes_of(camera).forward;
    double front = std::numeric_limits<double>::infinity();
    for (int corner = 0; corner < 8; ++corner) {
        const glm::bvec3 far(corner & 1, corner & 2, corner & 4);
        front = std::min(front, glm::dot(glm::mix(lower, upper, far) * volume.spacing - camera.eye, forward));
    }
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
