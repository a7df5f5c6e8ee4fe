#include "engine/look/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace shvr {

namespace {

constexpr double WIDTH = 1.5;        ///< pixels
constexpr double TRACE_WIDTH = 2.5;  ///< for highlighted parts of the trace
constexpr double HALO = 2.0;         ///< pixels added around a stroke, to set it off from what is behind it
constexpr double DASH = 5.0, GAP = 4.0;
constexpr glm::dvec3 DARK(0.02);
/// Colours of the axes x, y and z.
constexpr std::array<glm::dvec3, 3> COLORS{glm::dvec3(0.87, 0.05, 0.03), glm::dvec3(0.05, 0.55, 0.08),
                                           glm::dvec3(0.06, 0.22, 0.95)};

/// Clips a line to the pane plus a small margin (Liang and Barsky 1984); null if nothing is left.
std::optional<std::pair<glm::dvec2, glm::dvec2>> clipped(const glm::dvec2& from, const glm::dvec2& to,
                                                         const glm::uvec2& pixels)
{
    constexpr double SPARE = 8.0;
    const glm::dvec2 way = to - from;
    double begin = 0.0, end = 1.0;
    for (int axis = 0; axis < 2; ++axis)
        for (const int side : {-1, 1}) {
            const double room = side > 0 ? pixels[axis] + SPARE - from[axis] : from[axis] + SPARE;
            const double speed = side * way[axis];
            if (speed == 0.0) {
                if (room < 0.0) return std::nullopt;
            } else if (speed > 0.0) {
                end = std::min(end, room / speed);
            } else {
                begin = std::max(begin, room / speed);
            }
        }
    if (!(begin < end)) return std::nullopt;
    return std::pair{from + begin * way, from + end * way};
}

class Strokes {
public:
    explicit Strokes(const glm::uvec2& pixels) : pixels_(pixels) {}

    void line(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, bool stippled = false,
              double width = WIDTH, double halo = HALO)
    {
        const auto seen = clipped(from, to, pixels_);
        if (!seen) return;
        const auto [a, b] = *seen;
        const double length = glm::distance(a, b);
        if (!stippled) return add(a, b, color, width, halo);
        for (double at = 0.0; at < length; at += DASH + GAP)
            add(glm::mix(a, b, at / length), glm::mix(a, b, std::min(at + DASH, length) / length), color, width, halo);
    }
    void closed(const std::vector<glm::dvec2>& points, const glm::dvec3& color, double width = WIDTH,
                double halo = HALO)
    {
        for (size_t i = 0; i < points.size(); ++i)
            line(points[i], points[(i + 1) % points.size()], color, false, width, halo);
    }
    /// Returns all strokes, preceded by their halos, so that no halo covers another stroke.
    std::vector<Stroke> taken()
    {
        std::vector<Stroke> all;
        for (size_t i = 0; i < strokes_.size(); ++i) {
            Stroke stroke = strokes_[i];
            stroke.color = DARK;
            stroke.width += halos_[i];
            all.push_back(stroke);
        }
        all.insert(all.end(), strokes_.begin(), strokes_.end());
        return all;
    }

private:
    void add(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, double width, double halo)
    {
        strokes_.push_back({from, to, color, width});
        halos_.push_back(halo);
    }
    glm::uvec2 pixels_;
    std::vector<Stroke> strokes_;
    std::vector<double> halos_;  ///< pixels added around each
};

/// Returns the corners of a camera's frustum, near 0 ... 3 and far 4 ... 7, both in the order top left, top right,
/// bottom left, bottom right. Without a far plane, the frustum ends where the volume does.
std::array<glm::dvec3, 8> frustum_corners(const Camera& camera, const glm::uvec2& pixels, const VolumeInfo& volume)
{
    const glm::dvec3 extent = glm::dvec3(volume.size) * volume.spacing;
    const glm::dvec3 forward = axes_of(camera).forward;
    const double behind = glm::dot(0.5 * extent - camera.eye, forward) + 0.5 * glm::length(extent);
    const double near = camera.near_distance;
    const double far = camera.far_distance > 0.0 ? camera.far_distance : std::max(behind, near);
    std::array<glm::dvec3, 8> corners;
    for (size_t i = 0; i < 8; ++i)
        corners[i] = unproject(camera, pixels, glm::dvec2(pixels) * glm::dvec2(i & 1, i >> 1 & 1), i < 4 ? near : far);
    return corners;
}

/// Returns the convex hull of points, by Andrew's monotone chain (1979).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points)
{
    std::ranges::sort(points,
                      [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    const auto turns_left = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0;
    };
    std::vector<glm::dvec2> hull;
    for (int side = 0; side < 2; ++side) {
        const size_t first = hull.size();
        for (const glm::dvec2& point : points) {
            while (hull.size() >= first + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point)) hull.pop_back();
            hull.push_back(point);
        }
        hull.pop_back();  // the first point of the other side
        std::ranges::reverse(points);
    }
    return hull;
}

/// Draws the volume's outline and that of what the main camera sees, as thin lines of one colour each.
void add_overview(Strokes& strokes, const Pane& pane, const glm::uvec2& pixels, const OverlayScene& scene,
                  const VolumeInfo& volume)
{
    constexpr double THIN = 1.0, THIN_HALO = 1.0;  // pixels
    constexpr glm::dvec3 OUTLINE(0.3), SEEN(0.95, 0.62, 0.18);
    const auto outline = [&](const std::array<glm::dvec3, 8>& corners, const glm::dvec3& color) {
        std::vector<glm::dvec2> points;
        for (const glm::dvec3& corner : corners)
            if (const auto at = project(pane.shot.camera, pixels, corner)) points.push_back(at->pixel);
        strokes.closed(hull_of(std::move(points)), color, THIN, THIN_HALO);
    };
    std::array<glm::dvec3, 8> box;
    for (size_t i = 0; i < 8; ++i)
        box[i] = glm::dvec3(volume.size) * volume.spacing * glm::dvec3(i & 1, i >> 1 & 1, i >> 2 & 1);
    outline(box, OUTLINE);
    outline(frustum_corners(scene.main, scene.main_pixels, volume), SEEN);
}

/// Draws where the other two slices cut this one: two lines in the colours of their axes, with a gap where they meet.
void add_cross(Strokes& strokes, const Pane& pane, const glm::uvec2& pixels, const OverlayScene& scene)
{
    constexpr double OPEN = 12.0;  ///< pixels
    const auto at = project(pane.shot.camera, pixels, scene.cross.value_or(scene.probe.center));
    if (!at) return;
    const CameraAxes axes = axes_of(pane.shot.camera);
    const auto axis_of = [](const glm::dvec3& direction) {
        const glm::dvec3 size = glm::abs(direction);
        return size.x > size.y && size.x > size.z ? 0u : size.y > size.z ? 1u : 2u;
    };
    const glm::dvec2 end(pixels), pixel = at->pixel;
    const glm::dvec3 upright = COLORS[axis_of(axes.right)], level = COLORS[axis_of(axes.up)];
    strokes.line({pixel.x, 0.0}, {pixel.x, pixel.y - OPEN}, upright);
    strokes.line({pixel.x, pixel.y + OPEN}, {pixel.x, end.y}, upright);
    strokes.line({0.0, pixel.y}, {pixel.x - OPEN, pixel.y}, level);
    strokes.line({pixel.x + OPEN, pixel.y}, {end.x, pixel.y}, level);
}

/// Draws an arrow at the border of the pane that points towards the probe.
void add_arrow(Strokes& strokes, const glm::uvec2& pixels, const glm::dvec2& way, const glm::dvec3& color)
{
    constexpr double SPARE = 14.0, SHAFT = 34.0, HEAD = 11.0;
    const glm::dvec2 middle = 0.5 * glm::dvec2(pixels), room = glm::max(middle - SPARE, glm::dvec2(1.0));
    const glm::dvec2 shares = glm::abs(way) / room;
    const glm::dvec2 tip = middle + way / std::max(shares.x, shares.y);
    const glm::dvec2 along = glm::normalize(way), across(-along.y, along.x);
    strokes.line(tip - SHAFT * along, tip, color);
    for (const double side : {-1.0, 1.0}) strokes.line(tip, tip - HEAD * along + 0.6 * side * HEAD * across, color);
}

/// Draws the border between a pane and its neighbours.
void add_border(Strokes& strokes, const Pane& pane, const glm::uvec2& pixels)
{
    constexpr glm::dvec3 GREY(0.2);
    if (pane.box.begin.x > 0) strokes.line({0.0, 0.0}, {0.0, pixels.y}, GREY);
    if (pane.box.begin.y > 0) strokes.line({0.0, 0.0}, {pixels.x, 0.0}, GREY);
}

void add_probe(Strokes& strokes, const Camera& camera, const glm::uvec2& pixels, const OverlayScene::Probe& probe)
{
    const std::vector<glm::dvec2> outline = silhouette_of(camera, pixels, probe.center, probe.radius);
    const bool is_in_sight = std::ranges::any_of(outline, [&](const glm::dvec2& at) {
        return glm::all(glm::greaterThanEqual(at, glm::dvec2(0.0))) && glm::all(glm::lessThan(at, glm::dvec2(pixels)));
    });
    if (is_in_sight) {
        if (probe.is_outlined) strokes.closed(outline, probe.color);
        return;
    }
    if (!probe.has_arrow) return;
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 from_eye = probe.center - camera.eye;
    glm::dvec2 way(glm::dot(from_eye, axes.right), -glm::dot(from_eye, axes.up));
    if (const auto at = project(camera, pixels, probe.center)) {
        way = at->pixel - 0.5 * glm::dvec2(pixels);
        const glm::dvec2 inside = glm::abs(way) - 0.5 * glm::dvec2(pixels);
        if (inside.x < 0.0 && inside.y < 0.0) return;  // in view, if the ball covers the whole pane or contains the eye
    }
    if (glm::length(way) > 1e-9) add_arrow(strokes, pixels, way, probe.color);
}

/// Draws a ball as a ring, with a minimum size in pixels so that it is visible from any distance.
void add_ball(Strokes& strokes, const Pane& pane, const glm::uvec2& pixels, const OverlayScene::Ball& ball)
{
    constexpr double LEAST = 5.0, APART = 2.5;  ///< pixels
    const Camera& camera = pane.shot.camera;
    double radius = ball.radius;
    if (pane.kind == Pane::Kind::slice) {  // drawn as the circle in which the slice cuts the ball
        const double depth = glm::dot(ball.center - camera.eye, axes_of(camera).forward);
        const double away = depth - 0.5 * (camera.near_distance + camera.far_distance);
        if (!(std::abs(away) < radius)) return;
        radius = std::sqrt(radius * radius - away * away);
    }
    const auto at = project(camera, pixels, ball.center);
    if (!at) return;
    const std::vector<glm::dvec2> outline = silhouette_of(camera, pixels, ball.center, radius);
    double reach = 0.0;
    for (const glm::dvec2& point : outline) reach = std::max(reach, glm::distance(point, at->pixel));
    if (outline.empty()) return;
    const double scale = std::max(reach + APART, LEAST) / std::max(reach, 1e-9);
    std::vector<glm::dvec2> ring;
    for (const glm::dvec2& point : outline) ring.push_back(at->pixel + scale * (point - at->pixel));
    strokes.closed(ring, ball.color, TRACE_WIDTH);
}

void add_trace(Strokes& strokes, const Pane& pane, const glm::uvec2& pixels, const OverlayScene& scene)
{
    if (pane.kind != Pane::Kind::slice)  // not in slices, since the lines do not lie in their planes
        for (const OverlayScene::Line& line : scene.lines) {
            const auto from = project(pane.shot.camera, pixels, line.from);
            const auto to = project(pane.shot.camera, pixels, line.to);
            if (from && to) strokes.line(from->pixel, to->pixel, line.color, false, TRACE_WIDTH);
        }
    for (const OverlayScene::Ball& ball : scene.balls) add_ball(strokes, pane, pixels, ball);
}

/// Draws a box's edges in the colours of their axes: solid if an adjacent face faces the viewer, stippled if not.
void add_box(Strokes& strokes, const Camera& camera, const glm::uvec2& pixels, const OverlayScene::Box& box)
{
    const CameraAxes axes = axes_of(camera);
    const bool is_perspective = camera.projection == Camera::Projection::perspective;
    const double nearest = 1e-3 * glm::distance(camera.eye, camera.target);
    const glm::dvec3 middle = 0.5 * (box.lower + box.upper);
    const auto depth_of = [&](const glm::dvec3& point) { return glm::dot(point - camera.eye, axes.forward); };
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 4; ++side) {
            const int second = (axis + 1) % 3, third = (axis + 2) % 3;
            glm::dvec3 from = box.lower, to;
            if (side & 1) from[second] = box.upper[second];
            if (side & 2) from[third] = box.upper[third];
            to = from;
            to[axis] = box.upper[axis];
            // An edge is visible if at least one of the two faces that meet in it faces the viewer.
            const glm::dvec3 to_viewer = is_perspective ? camera.eye - 0.5 * (from + to) : -axes.forward;
            const auto faces = [&](int normal) { return (from[normal] - middle[normal]) * to_viewer[normal] > 0.0; };
            const bool is_seen = faces(second) || faces(third);
            if (is_perspective) {  // clips the edge to the part in front of the eye
                const double begin = depth_of(from), end = depth_of(to);
                if (begin < nearest && end < nearest) continue;
                const glm::dvec3 way = to - from;
                if (begin < nearest) from += way * ((nearest - begin) / (end - begin));
                if (end < nearest) to -= way * ((nearest - end) / (begin - end));
            }
            const auto a = project(camera, pixels, from), b = project(camera, pixels, to);
            if (a && b) strokes.line(a->pixel, b->pixel, COLORS[size_t(axis)], !is_seen);
        }
}

/// Calls `paint` with each pixel of `pane` that a stroke covers, and the coverage. `origin` is the strokes' origin.
template <class Paint>
void for_each_covered(const Stroke& stroke, const glm::uvec2& origin, const PixelBox& pane, const Paint& paint)
{
    const glm::dvec2 from = stroke.from + glm::dvec2(origin), to = stroke.to + glm::dvec2(origin);
    const double reach = 0.5 * stroke.width + 0.5;
    const glm::dvec2 lower = glm::max(glm::floor(glm::min(from, to) - reach), glm::dvec2(pane.begin));
    const glm::dvec2 upper = glm::min(glm::ceil(glm::max(from, to) + reach), glm::dvec2(pane.end));
    const glm::dvec2 way = to - from;
    const double square = glm::dot(way, way);
    // Finds the short piece that a long stroke covers in each row, so that the rest of the row can be skipped.
    const auto x_at = [&](double y) {
        return way.y == 0.0 ? 0.0 : from.x + std::clamp((y - from.y) / way.y, 0.0, 1.0) * way.x;
    };
    for (int y = int(lower.y); y < int(upper.y); ++y) {
        int begin = int(lower.x), end = int(upper.x);
        if (way.y != 0.0) {
            const double above = x_at(y - reach), below = x_at(y + 1.0 + reach);
            begin = std::max(begin, int(std::floor(std::max(std::min(above, below) - reach, lower.x))) - 1);
            end = std::min(end, int(std::ceil(std::min(std::max(above, below) + reach, upper.x))) + 1);
        }
        for (int x = begin; x < end; ++x) {
            const glm::dvec2 at = glm::dvec2(x, y) + 0.5 - from;
            const double along = square > 0.0 ? glm::dot(at, way) / square : 0.0, share = std::clamp(along, 0.0, 1.0);
            double covered = std::clamp(reach - glm::length(at - share * way), 0.0, 1.0);
            if (stroke.has_flat_ends) {
                const double inside = std::min(along, 1.0 - along) * std::sqrt(square);
                const double across = glm::length(at - along * way);
                covered = std::clamp(reach - across, 0.0, 1.0) * std::clamp(inside + 0.5, 0.0, 1.0);
            }
            if (covered > 0.0) paint(size_t(x), size_t(y), covered);
        }
    }
}

}  // namespace

std::vector<glm::dvec2> silhouette_of(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& center,
                                      double radius)
{
    constexpr int CORNERS = 48;
    const CameraAxes axes = axes_of(camera);
    glm::dvec3 middle = center, right = axes.right, up = axes.up;
    double reach = radius;
    if (camera.projection == Camera::Projection::perspective) {
        const glm::dvec3 to_eye = camera.eye - center;
        const double distance = glm::length(to_eye);
        if (!(distance > radius)) return {};
        const double sine = radius / distance;
        middle += to_eye * (sine * sine);
        reach *= std::sqrt(1.0 - sine * sine);
        const glm::dvec3 towards = to_eye / distance;
        right = glm::normalize(glm::cross(axes.up, towards));
        up = glm::cross(towards, right);
    }
    std::vector<glm::dvec2> outline;
    for (int i = 0; i < CORNERS; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / CORNERS;
        const auto at = project(camera, pixels, middle + reach * (std::cos(angle) * right + std::sin(angle) * up));
        if (!at) return {};
        outline.push_back(at->pixel);
    }
    return outline;
}

OverlayScene overlay_of(const ViewSettings& view, const CutBox& cut, const Camera& main, const glm::uvec2& main_pixels,
                        const glm::dvec3& probe_voxel, const VolumeInfo& volume)
{
    OverlayScene scene{.main = main,
                       .main_pixels = main_pixels,
                       .probe = {.center = probe_voxel * volume.spacing, .is_outlined = false, .has_arrow = false}};
    if (view.slices.cross) scene.cross = *view.slices.cross * volume.spacing;
    if (view.cut_box) scene.box = box_of(cut, volume);
    return scene;
}

OverlayScene::Box box_of(const CutBox& cut, const VolumeInfo& volume)
{
    const glm::dvec3 size(volume.size);
    return {glm::min(cut.lower, size) * volume.spacing, glm::min(cut.upper, size) * volume.spacing};
}

std::vector<Stroke> strokes_of(const Pane& pane, const OverlayScene& scene, const VolumeInfo& volume)
{
    const glm::uvec2 pixels = pane.box.end - pane.box.begin;
    Strokes strokes(pixels);
    if (pane.kind == Pane::Kind::map || pane.kind == Pane::Kind::slice) add_border(strokes, pane, pixels);
    if (pane.kind == Pane::Kind::map) add_overview(strokes, pane, pixels, scene, volume);
    if (pane.kind == Pane::Kind::slice) add_cross(strokes, pane, pixels, scene);
    // Anaglyphs get no outline: it can only be drawn for one camera, so the two eyes would see it at a wrong depth.
    if ((scene.probe.is_outlined || scene.probe.has_arrow) && pane.kind != Pane::Kind::slice && !pane.shot.right_eye)
        add_probe(strokes, pane.shot.camera, pixels, scene.probe);
    if (!pane.shot.right_eye) add_trace(strokes, pane, pixels, scene);
    if (scene.box && pane.kind != Pane::Kind::slice && !pane.shot.right_eye)
        add_box(strokes, pane.shot.camera, pixels, *scene.box);
    return strokes.taken();
}

void draw_strokes(ImageF& image, std::span<const Stroke> strokes, const PixelBox& pane, uint32_t first_row)
{
    PixelBox rows = pane;
    rows.begin.y = std::max(rows.begin.y, first_row);
    rows.end.y = std::min(rows.end.y, first_row + uint32_t(image.height));
    for (const Stroke& stroke : strokes)
        for_each_covered(stroke, pane.begin, rows, [&](size_t x, size_t y, double covered) {
            float* const pixel = &image.rgba[4 * (x + size_t(image.width) * (y - first_row))];
            for (int c = 0; c < 4; ++c)
                pixel[c] = float(pixel[c] + covered * ((c < 3 ? stroke.color[c] : 1.0) - pixel[c]));
        });
}

void draw_strokes(Image8& image, std::span<const Stroke> strokes, const PixelBox& pane)
{
    for (const Stroke& stroke : strokes)
        for_each_covered(stroke, pane.begin, pane, [&](size_t x, size_t y, double covered) {
            uint8_t* const pixel = &image.rgba[4 * (x + size_t(image.width) * y)];
            for (int c = 0; c < 3; ++c) {
                const double light = glm::mix(srgb_decode(pixel[c] / 255.0), stroke.color[c], covered);
                pixel[c] = uint8_t(std::lround(255.0 * srgb_encode(std::clamp(light, 0.0, 1.0))));
            }
        });
}

}  // namespace shvr
