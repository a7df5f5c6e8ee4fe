#include "engine/look/panes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shvr {

namespace {

constexpr uint32_t MIN_PANE = 16;      ///< pixels a side
constexpr double SLICE_MARGIN = 1.05;  ///< height of a slice's view, relative to the volume's
constexpr double MAP_MARGIN = 1.5;     ///< likewise, for maps, which also show a camera outside the volume

PixelBox part_of(const glm::uvec2& pixels, const glm::uvec2& counts, const glm::uvec2& at)
{
    return {pixels * at / counts, pixels * (at + 1u) / counts};
}

glm::uvec2 size_of(const PixelBox& box)
{
    return box.end - box.begin;
}

/// Returns the height of an orthographic view that shows all of `extent` (width, height).
double height_for(const glm::dvec2& extent, const glm::uvec2& pixels)
{
    return std::max(extent.y, extent.x * pixels.y / pixels.x);
}

/// Returns a map: the whole volume from a side. `around` is the height of the view relative to that of the volume.
Pane map_pane(const std::string& side, const PixelBox& box, const VolumeInfo& volume, double around)
{
    Camera camera = camera_looking(side, volume);
    camera.projection = Camera::Projection::orthographic;
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 extent = glm::dvec3(volume.size) * volume.spacing;
    camera.height = around * height_for({glm::dot(glm::abs(axes.right), extent), glm::dot(glm::abs(axes.up), extent)},
                                        size_of(box));
    return {.kind = Pane::Kind::map, .shot = camera, .box = box, .name = side};
}

/// Returns the voxel at the centre of all slices.
glm::dvec3 middle_of(const SliceSettings& slices, const VolumeInfo& volume, const glm::dvec3& probe_voxel)
{
    const glm::dvec3 size(volume.size);
    if (!slices.center && slices.zoom <= 1.0) return 0.5 * size;
    return glm::clamp(slices.center.value_or(cross_of(slices, probe_voxel)), glm::dvec3(0.0), size);
}

/// Returns the axis of the volume that is closest to `direction`.
int axis_along(const glm::dvec3& direction)
{
    const glm::dvec3 size = glm::abs(direction);
    return size.x > size.y ? (size.x > size.z ? 0 : 2) : size.y > size.z ? 1 : 2;
}

/// Returns the slice through the cross that is perpendicular to `axis`: z seen from the top, y from the front, x from
/// the right, like the volume in these views.
Pane slice_pane(int axis, const PixelBox& box, const VolumeInfo& volume, const glm::dvec3& probe_voxel,
                const SliceSettings& slices)
{
    const char* const SIDE_BY_AXIS[] = {"right", "front", "top"};
    Pane pane = map_pane(SIDE_BY_AXIS[axis], box, volume, SLICE_MARGIN / slices.zoom);
    Camera& camera = pane.shot.camera;
    const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
    const glm::dvec3 size(volume.size);
    // The slice must stay slightly inside the volume's end, even after a kernel's rounding to floats: exactly at the
    // end, the volume would be drawn without an edge.
    constexpr double LAST = 1.0 - 1e-6;
    const double voxel = std::clamp(cross_of(slices, probe_voxel)[axis], 0.0, LAST * size[axis]);
    if (slices.center || slices.zoom > 1.0) {
        const glm::dvec3 way = middle_of(slices, volume, probe_voxel) * volume.spacing - camera.target;
        camera.target += way;
        camera.eye += way;
    }
    const double depth = std::abs(voxel * volume.spacing[axis] - camera.eye[axis]);
    const double half = 0.5 * std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z});
    camera.target = camera.eye + forward * depth;
    camera.near_distance = std::max(depth - half, 0.0);
    camera.far_distance = camera.near_distance + 2.0 * half;
    pane.kind = Pane::Kind::slice;
    pane.shot.is_slice = true;
    pane.axis = axis;
    pane.name = std::string("slice across ") + "xyz"[axis];
    return pane;
}

std::vector<Pane> stereo_panes(const StereoSettings& settings, const Camera& main, const glm::uvec2& pixels)
{
    const auto [left, right] = eyes_of(main, settings);
    if (settings.output == StereoOutput::anaglyph) {
        Pane both{.kind = Pane::Kind::main, .shot = left, .box = {glm::uvec2(0), pixels}, .name = "both eyes"};
        both.shot.right_eye = right;
        return {both};
    }
    const glm::uvec2 counts = settings.output == StereoOutput::side_by_side ? glm::uvec2(2, 1) : glm::uvec2(1, 2);
    return {
        {.kind = Pane::Kind::left_eye, .shot = left, .box = part_of(pixels, counts, glm::uvec2(0)), .name = "left eye"},
        {.kind = Pane::Kind::right_eye,
         .shot = right,
         .box = part_of(pixels, counts, counts - 1u),
         .name = "right eye"}};
}

}  // namespace

std::pair<Camera, Camera> eyes_of(const Camera& camera, const StereoSettings& settings)
{
    const CameraAxes axes = axes_of(camera);
    const double reach = glm::distance(camera.eye, camera.target);
    const double half = 0.5 * settings.eye_distance * reach;
    const bool is_perspective = camera.projection == Camera::Projection::perspective;
    std::array<Camera, 2> eyes{camera, camera};
    for (const int side : {-1, 1}) {
        Camera& eye = eyes[side > 0];
        const glm::dvec3 way = double(side) * half * axes.right;
        eye.eye += way;
        if (half > 0.0 && (settings.toe_in || !is_perspective)) {
            eye.up = axes.up;  // both eyes rotate about this up vector, so that neither eye rolls
            continue;
        }
        eye.target += way;
        const double height = 2.0 * std::tan(camera.fov_y_degrees * (0.5 * std::numbers::pi / 180.0)) * reach;
        eye.shift_right -= side * half / height;
    }
    return {eyes[0], eyes[1]};
}

std::vector<Pane> panes_of(const ViewSettings& settings, const Camera& main, const glm::uvec2& pixels,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel)
{
    const std::vector<Pane> one{
        {.kind = Pane::Kind::main, .shot = main, .box = {glm::uvec2(0), pixels}, .name = "camera"}};
    const bool is_divided = settings.arrangement != Arrangement::single;
    if (!is_divided || glm::any(glm::lessThan(pixels, glm::uvec2(2 * MIN_PANE)))) return one;
    if (settings.arrangement == Arrangement::stereo) return stereo_panes(settings.stereo, main, pixels);

    const glm::uvec2 counts(2);
    const auto quarter = [&](uint32_t x, uint32_t y) { return part_of(pixels, counts, {x, y}); };
    std::vector<Pane> panes = one;
    panes[0].box = quarter(0, 0);
    if (settings.arrangement == Arrangement::overview) {
        panes.push_back(map_pane("top", quarter(1, 0), volume, MAP_MARGIN / settings.overview_zoom));
        panes.push_back(map_pane("front", quarter(0, 1), volume, MAP_MARGIN / settings.overview_zoom));
        panes.push_back(map_pane("right", quarter(1, 1), volume, MAP_MARGIN / settings.overview_zoom));
    } else {
        panes.push_back(slice_pane(2, quarter(1, 0), volume, probe_voxel, settings.slices));
        panes.push_back(slice_pane(1, quarter(0, 1), volume, probe_voxel, settings.slices));
        panes.push_back(slice_pane(0, quarter(1, 1), volume, probe_voxel, settings.slices));
    }
    return panes;
}

SliceSettings slices_zoomed(const SliceSettings& slices, const Pane& slice, const glm::dvec2& pixel, double factor,
                            const VolumeInfo& volume, const glm::dvec3& probe_voxel)
{
    constexpr double MOST = 1e3;
    SliceSettings zoomed = slices;
    zoomed.zoom = std::clamp(slices.zoom * factor, 1.0, MOST);
    zoomed.center.reset();
    if (zoomed.zoom == 1.0) return zoomed;
    const double share = slices.zoom / zoomed.zoom;
    const glm::dvec3 held = unproject(slice.shot.camera, slice.pixels(), pixel, 0.0) / volume.spacing;
    glm::dvec3 middle = middle_of(slices, volume, probe_voxel);
    for (int axis = 0; axis < 3; ++axis)
        if (axis != slice.axis) middle[axis] = held[axis] + share * (middle[axis] - held[axis]);
    zoomed.center = glm::clamp(middle, glm::dvec3(0.0), glm::dvec3(volume.size));
    return zoomed;
}

SliceSettings slices_moved(const SliceSettings& slices, const Pane& slice, const glm::dvec2& way,
                           const VolumeInfo& volume, const glm::dvec3& probe_voxel)
{
    const CameraAxes axes = axes_of(slice.shot.camera);
    const glm::dvec2 units = way * pixel_size(slice.shot.camera, slice.pixels(), 1.0);
    const glm::dvec3 middle = middle_of(slices, volume, probe_voxel);
    SliceSettings moved = slices;
    moved.center = glm::clamp(middle - (axes.right * units.x - axes.up * units.y) / volume.spacing, glm::dvec3(0.0),
                              glm::dvec3(volume.size));
    return moved;
}

SliceSettings slices_following(const SliceSettings& slices, const std::vector<Pane>& panes, std::optional<size_t> held,
                               const VolumeInfo& volume, const glm::dvec3& probe_voxel)
{
    const glm::dvec3 cross = cross_of(slices, probe_voxel);
    const glm::dvec3 seen = glm::clamp(cross, glm::dvec3(0.0), glm::dvec3(volume.size)) * volume.spacing;
    glm::bvec3 follows(false);
    int held_axis = -1;  // the slice under the mouse if the cross is visible there: it must not move
    for (size_t i = 0; i < panes.size(); ++i) {
        const Pane& pane = panes[i];
        if (!pane.shot.is_slice) continue;
        const CameraAxes axes = axes_of(pane.shot.camera);
        const glm::dvec2 at = project(pane.shot.camera, pane.pixels(), seen)->pixel, end(pane.pixels());
        const bool is_beside = at.x < 0.0 || at.x > end.x, is_above = at.y < 0.0 || at.y > end.y;
        if (is_beside) follows[axis_along(axes.right)] = true;
        if (is_above) follows[axis_along(axes.up)] = true;
        if (held == i && !is_beside && !is_above) held_axis = pane.axis;
    }
    SliceSettings next = slices;
    glm::dvec3 middle = middle_of(slices, volume, probe_voxel);
    for (int axis = 0; axis < 3; ++axis) {
        if (!follows[axis] || (held_axis >= 0 && axis != held_axis)) continue;
        middle[axis] = seen[axis] / volume.spacing[axis];
        next.center = middle;
    }
    return next;
}

}  // namespace shvr
