#include "engine/workbench/sight/plane_handles.h"

#include <algorithm>
#include <cmath>

#include "engine/look/cut_corners.h"
#include "engine/workbench/sight/cut_handles.h"
#include "engine/workbench/sight/hits.h"

namespace shvr::ui {

namespace {

/// Least sine of the angle between the plane and a slice in which it is shown.
constexpr double MIN_SLICE_SINE = 0.02;
/// Maximum length of the normal that is drawn, as shares of the volume's diagonal and of the height of the view.
constexpr double VOLUME_SHARE = 0.2, VIEW_SHARE = 0.2;

/// The plane in volume space.
struct Plane {
    glm::dvec3 point, normal;  ///< the normal is a unit vector
    double reach;              ///< length of the normal that is drawn
    glm::dvec3 tip() const { return point + reach * normal; }
};

double depth_of(const Pane& pane, const glm::dvec3& point)
{
    return glm::dot(point - pane.shot.camera.eye, axes_of(pane.shot.camera).forward);
}

std::optional<Plane> plane_of(const Pane& pane, const CutBox& cut, const VolumeInfo& volume)
{
    if (!cut.plane_normal || pane.kind == Pane::Kind::map || pane.shot.right_eye) return std::nullopt;
    const glm::dvec3 extent = glm::dvec3(volume.size) * volume.spacing;
    const glm::dvec3 point = cut.plane_point ? *cut.plane_point * volume.spacing : 0.5 * extent;
    const double height = pane.pixels().y * pixel_size(pane.shot.camera, pane.pixels(), depth_of(pane, point));
    if (!(height > 0.0)) return std::nullopt;  // behind the eye
    return Plane{point, glm::normalize(*cut.plane_normal),
                 std::min(VOLUME_SHARE * glm::length(extent), VIEW_SHARE * height)};
}

std::optional<glm::dvec2> pixel_of(const Pane& pane, const glm::dvec3& point)
{
    const auto at = project(pane.shot.camera, pane.pixels(), point);
    return at ? std::optional(at->pixel) : std::nullopt;
}

/// The plane's line in a slice.
struct SliceLine {
    glm::dvec3 foot;    ///< point on the line at which the normal is drawn
    glm::dvec3 along;   ///< unit vector along the line
    glm::dvec3 normal;  ///< unit vector in the slice, perpendicular to the line, towards what is removed
    double sine;        ///< sine of the angle between plane and slice
    double reach;
    glm::dvec3 tip() const { return foot + reach * normal; }
};

std::optional<SliceLine> line_in_slice(const Pane& pane, const Plane& plane)
{
    const glm::dvec3 forward = axes_of(pane.shot.camera).forward;
    const glm::dvec3 in_slice = plane.normal - forward * glm::dot(plane.normal, forward);
    const double sine = glm::length(in_slice);
    if (sine < MIN_SLICE_SINE) return std::nullopt;
    const glm::dvec3 normal = in_slice / sine, along = glm::cross(normal, forward);
    const auto onto_line = [&](glm::dvec3 point) {
        point -= forward * behind_plane(pane.shot.camera, point);
        return point - normal * (glm::dot(point - plane.point, plane.normal) / sine);
    };
    glm::dvec3 foot = onto_line(plane.point);
    const auto at = pixel_of(pane, foot);
    if (!at || glm::any(glm::lessThan(*at, glm::dvec2(0.0))) ||
        glm::any(glm::greaterThan(*at, glm::dvec2(pane.pixels()))))
        foot = onto_line(unproject(pane.shot.camera, pane.pixels(), 0.5 * glm::dvec2(pane.pixels()), 1.0));
    return SliceLine{foot, along, normal, sine, plane.reach};
}

/// Returns the part of a line that is in the volume.
std::optional<std::pair<glm::dvec3, glm::dvec3>> within_volume(const SliceLine& line, const VolumeInfo& volume)
{
    double begin = -1e30, end = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        const double most = double(volume.size[axis]) * volume.spacing[axis];
        if (std::abs(line.along[axis]) < 1e-9) {
            const double room = 1e-6 * most;
            if (line.foot[axis] < -room || line.foot[axis] > most + room) return std::nullopt;
            continue;
        }
        const double a = -line.foot[axis] / line.along[axis], b = (most - line.foot[axis]) / line.along[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(begin < end)) return std::nullopt;
    return std::pair(line.foot + begin * line.along, line.foot + end * line.along);
}

/// Returns the corners of the polygon in which the plane crosses the uncut box, in order.
std::vector<glm::dvec3> section_of(const Plane& plane, const CutBox& cut, const VolumeInfo& volume)
{
    std::vector<glm::dvec3> corners;
    const double near = 1e-9 * glm::length(glm::dvec3(volume.size) * volume.spacing);
    for (const glm::dvec3& corner : corners_left(cut, volume)) {
        const glm::dvec3 point = corner * volume.spacing;
        if (std::abs(glm::dot(point - plane.point, plane.normal)) <= near) corners.push_back(point);
    }
    if (corners.size() < 3) return {};
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& corner : corners) middle += corner / double(corners.size());
    const glm::dvec3 right = glm::normalize(corners[0] - middle), up = glm::cross(plane.normal, right);
    std::ranges::sort(corners, {}, [&](const glm::dvec3& corner) {
        return std::atan2(glm::dot(corner - middle, up), glm::dot(corner - middle, right));
    });
    return corners;
}

/// Whether the normal points so nearly along the line of sight that the pointer cannot follow it.
bool is_end_on(const Pane& pane, const Plane& plane)
{
    const auto at = pixel_of(pane, plane.point);
    return at && !place_along(pane, plane.point, plane.normal, *at);
}

/// Returns where the handle that moves the plane is, if the normal points along the line of sight.
glm::dvec3 below(const Pane& pane, const Plane& plane)
{
    const glm::dvec3 up = axes_of(pane.shot.camera).up;
    return plane.point - plane.reach * glm::normalize(up - plane.normal * glm::dot(up, plane.normal));
}

/// Moves the plane along its normal, as far as it meets the volume.
CutBox moved(const CutBox& cut, const Plane& plane, const VolumeInfo& volume, double way)
{
    double least = 1e300, most = -1e300;
    for (const glm::dvec3& corner : corners_left(CutBox{}, volume)) {
        const double away = glm::dot(corner * volume.spacing - plane.point, plane.normal);
        least = std::min(least, away);
        most = std::max(most, away);
    }
    CutBox after = cut;
    after.plane_point = (plane.point + std::clamp(way, least, most) * plane.normal) / volume.spacing;
    return after;
}

/// Returns how far along the normal a drag moves the plane.
double way_of_drag(const Plane& plane, const Pane& pane, const glm::dvec2& from, const glm::dvec2& to)
{
    const Camera& camera = pane.shot.camera;
    if (is_end_on(pane, plane)) {
        const double away = (from.y - to.y) * pixel_size(camera, pane.pixels(), depth_of(pane, plane.point));
        return glm::dot(plane.normal, axes_of(camera).forward) < 0.0 ? -away : away;
    }
    const auto begin = place_along(pane, plane.point, plane.normal, from),
               end = place_along(pane, plane.point, plane.normal, to);
    return begin && end ? *end - *begin : 0.0;
}

/// Returns the normal whose tip, on a sphere around the plane's point, a pixel shows. The tip stays on the side of the
/// sphere, near or far, on which it is; outside of the sphere's outline, it follows along that.
glm::dvec3 tilted(const Plane& plane, const Pane& pane, const glm::dvec2& way)
{
    const auto tip = project(pane.shot.camera, pane.pixels(), plane.tip());
    if (!tip) return plane.normal;
    const auto sight_through = [&](const glm::dvec2& pixel) {
        const glm::dvec3 near = unproject(pane.shot.camera, pane.pixels(), pixel, 0.5 * tip->depth);
        return std::pair(near, glm::normalize(unproject(pane.shot.camera, pane.pixels(), pixel, tip->depth) - near));
    };
    const double side = glm::dot(plane.normal, sight_through(tip->pixel).second) < 0.0 ? -1.0 : 1.0;
    const auto [near, along] = sight_through(tip->pixel + way);
    const glm::dvec3 closest = near + along * glm::dot(plane.point - near, along);
    const double square = plane.reach * plane.reach - glm::dot(closest - plane.point, closest - plane.point);
    return glm::normalize(closest + side * std::sqrt(std::max(square, 0.0)) * along - plane.point);
}

/// Moves or tilts the plane's line in a slice; tilting keeps the angle between plane and slice.
CutBox dragged_in_slice(const CutBox& cut, const PlaneHandle& handle, const Plane& plane, const Pane& pane,
                        const VolumeInfo& volume, const glm::dvec2& way)
{
    const std::optional<SliceLine> line = line_in_slice(pane, plane);
    if (!line) return cut;
    const CameraAxes axes = axes_of(pane.shot.camera);
    const double unit = pixel_size(pane.shot.camera, pane.pixels(), 1.0);
    const glm::dvec3 by = unit * (axes.right * way.x - axes.up * way.y);
    if (handle.kind == PlaneHandle::Kind::move)
        return moved(cut, plane, volume, glm::dot(by, line->normal) * line->sine);
    const glm::dvec3 towards = line->reach * line->normal + by;
    if (glm::length(towards) < 1e-3 * line->reach) return cut;
    CutBox after = cut;
    after.plane_normal = line->sine * glm::normalize(towards) + axes.forward * glm::dot(plane.normal, axes.forward);
    after.plane_point = line->foot / volume.spacing;
    return after;
}

}  // namespace

std::vector<PlaneHandle> plane_handles(const Pane& pane, const CutBox& cut, const VolumeInfo& volume)
{
    const std::optional<Plane> plane = plane_of(pane, cut, volume);
    if (!plane) return {};
    std::optional<glm::dvec2> foot, tip;
    if (pane.kind == Pane::Kind::slice) {
        const std::optional<SliceLine> line = line_in_slice(pane, *plane);
        if (!line || !within_volume(*line, volume)) return {};
        foot = pixel_of(pane, line->foot);
        tip = pixel_of(pane, line->tip());
    } else {
        foot = pixel_of(pane, is_end_on(pane, *plane) ? below(pane, *plane) : plane->point);
        tip = pixel_of(pane, plane->tip());
    }
    std::vector<PlaneHandle> handles;
    if (foot) handles.push_back({PlaneHandle::Kind::move, *foot});
    if (tip) handles.push_back({PlaneHandle::Kind::tilt, *tip});
    return handles;
}

CutBox dragged(const CutBox& cut, const PlaneHandle& handle, const Pane& pane, const VolumeInfo& volume,
               const glm::dvec2& from, const glm::dvec2& to)
{
    const std::optional<Plane> plane = plane_of(pane, cut, volume);
    if (!plane) return cut;
    if (pane.kind == Pane::Kind::slice) return dragged_in_slice(cut, handle, *plane, pane, volume, to - from);
    if (handle.kind == PlaneHandle::Kind::move) return moved(cut, *plane, volume, way_of_drag(*plane, pane, from, to));
    CutBox after = cut;
    after.plane_normal = tilted(*plane, pane, to - from);
    return after;
}

std::vector<PaneLine> plane_lines(const Pane& pane, const CutBox& cut, const VolumeInfo& volume)
{
    std::vector<PaneLine> lines;
    const std::optional<Plane> plane = plane_of(pane, cut, volume);
    if (!plane) return lines;
    const auto add = [&](const glm::dvec3& from, const glm::dvec3& to) {
        const auto begin = pixel_of(pane, from), end = pixel_of(pane, to);
        if (begin && end) lines.emplace_back(*begin, *end);
    };
    if (pane.kind == Pane::Kind::slice) {
        const std::optional<SliceLine> line = line_in_slice(pane, *plane);
        const auto ends = line ? within_volume(*line, volume) : std::nullopt;
        if (!ends) return lines;
        add(ends->first, ends->second);
        add(line->foot, line->tip());
        return lines;
    }
    const std::vector<glm::dvec3> section = section_of(*plane, cut, volume);
    for (size_t i = 0; i < section.size(); ++i) add(section[i], section[(i + 1) % section.size()]);
    add(plane->point, plane->tip());
    if (is_end_on(pane, *plane)) add(plane->point, below(pane, *plane));
    return lines;
}

CutBox cut_facing(const CutBox& cut, const Camera& camera, const VolumeInfo& volume)
{
    const glm::dvec3 lower = glm::max(cut.lower, glm::dvec3(0.0)), upper = glm::min(cut.upper, glm::dvec3(volume.size));
    const glm::dvec3 target = camera.target / volume.spacing;
    const bool is_left = glm::all(glm::greaterThan(target, lower)) && glm::all(glm::lessThan(target, upper));
    CutBox after = cut;
    after.plane_normal = -axes_of(camera).forward;
    after.plane_point = is_left ? target : 0.5 * (lower + upper);
    return after;
}

}  // namespace shvr::ui
