#include "engine/workbench/sight/marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/workbench/lists/group_list.h"
#include "engine/workbench/sight/cut_handles.h"
#include "engine/workbench/sight/hits.h"
#include "engine/workbench/sight/label_place.h"
#include "engine/workbench/sight/measure_lines.h"
#include "engine/workbench/sight/plane_handles.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

constexpr glm::dvec3 DARK(0.02), LIGHT(0.95), LINK(1.0, 0.83, 0.02), MEASURED(0.05, 0.9, 0.9), PLANE(1.0, 0.45, 0.95);
constexpr std::array<glm::dvec3, 3> AXES{glm::dvec3(0.95, 0.12, 0.08), glm::dvec3(0.1, 0.75, 0.15),
                                         glm::dvec3(0.15, 0.4, 1.0)};
constexpr double DASH = 6.0, GAP = 5.0;

double luminance_of(const glm::dvec3& linear)
{
    return glm::dot(linear, glm::dvec3(0.2126, 0.7152, 0.0722));
}

/// Whether the scan is there in a slice, rather than the background around it.
bool is_over_scan(const glm::dvec2& pixel, const Pane& slice, const VolumeInfo& volume)
{
    const auto corner = [&](const glm::dvec3& point) { return project(slice.shot.camera, slice.pixels(), point); };
    const auto a = corner(glm::dvec3(0.0)), b = corner(glm::dvec3(volume.size) * volume.spacing);
    return a && b && glm::all(glm::greaterThan(pixel, glm::min(a->pixel, b->pixel))) &&
           glm::all(glm::lessThan(pixel, glm::max(a->pixel, b->pixel)));
}

class Drawing {
public:
    Drawing(const Model& model, const Pane& pane, size_t index, double units, MarksFor purpose)
        : model_(model),
          pane_(pane),
          index_(index),
          units_(units),
          is_for_screen_(purpose == MarksFor::screen),
          pixels_(pane.pixels()),
          axes_(axes_of(pane.shot.camera)),
          color_(group_of(model.session.groups, std::max(model.session.probe.painted_group(), uint8_t(1))).color)
    {
        if (model.session.probe.painted_group() == 0) color_ = glm::dvec3(0.6);
    }

    Marks all()
    {
        if (is_slice()) {
            trace_in_slice();
            if (is_for_screen_) brush_ring();
        }
        if (is_for_screen_) clip_box();
        if (is_for_screen_) oblique_plane();
        if (is_for_screen_) drawn_tool();
        measurements();
        if (is_for_screen_) link();
        if (is_for_screen_) pivot();
        if (model_.session.interaction.axes) axes();
        if (model_.session.interaction.scale_bar) scale();
        if (model_.session.interaction.group_legend) groups();
        title();
        if (is_for_screen_ && is_main() && model_.session.interaction.probe_label) probe_label();
        return std::move(marks_);
    }

private:
    bool is_slice() const { return pane_.kind == Pane::Kind::slice; }
    bool is_main() const { return pane_.kind == Pane::Kind::main; }
    double voxel_along() const { return model_.volume.spacing[std::clamp(pane_.axis, 0, 2)]; }
    glm::dvec3 probe() const { return model_.probe_voxel * model_.volume.spacing; }
    glm::dvec3 tool() const { return model_.tool_voxel * model_.volume.spacing; }
    std::optional<glm::dvec2> pixel_of(const glm::dvec3& point) const
    {
        const auto at = project(pane_.shot.camera, pixels_, point);
        return at ? std::optional(at->pixel) : std::nullopt;
    }
    /// Draws a line with a halo around it, so that the line is visible on any picture.
    void line(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, double width = 1.5)
    {
        marks_.strokes.push_back({from, to, DARK, (width + 2.0) * units_});
        marks_.strokes.push_back({from, to, color, width * units_});
    }
    /// Draws a rectangle around a line, as wide as stated.
    void rectangle(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, double width)
    {
        marks_.strokes.push_back({from, to, color, width, true});
    }
    void dashed(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color)
    {
        constexpr double MOST = 4000.0;  // beyond any screen
        const double length = std::min(glm::distance(from, to), MOST * units_);
        if (length <= 0.0) return;
        const glm::dvec2 way = (to - from) / glm::distance(from, to);
        for (double at = 0.0; at < length; at += (DASH + GAP) * units_)
            line(from + at * way, from + std::min(at + DASH * units_, length) * way, color);
    }
    void closed(const std::vector<glm::dvec2>& points, const glm::dvec3& color, double width = 1.5)
    {
        // All of the halo first, else it would lie on the corners of the side before.
        for (const bool is_halo : {true, false})
            for (size_t i = 0; i < points.size(); ++i)
                marks_.strokes.push_back({points[i], points[(i + 1) % points.size()], is_halo ? DARK : color,
                                          (is_halo ? width + 2.0 : width) * units_});
    }
    void ring(const glm::dvec2& middle, double radius, const glm::dvec3& color, double width = 1.5)
    {
        constexpr int CORNERS = 48;
        std::vector<glm::dvec2> points;
        for (int i = 0; i < CORNERS; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / CORNERS;
            points.push_back(middle + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        closed(points, color, width);
    }
    /// Draws a handle: a thick ring with one halo around it.
    void knob(const glm::dvec2& middle, bool is_held, const glm::dvec3& color)
    {
        constexpr int CORNERS = 24;
        const double radius = (is_held ? 7.0 : 4.5) * units_;
        const auto corner = [&](int i) {
            const double angle = 2.0 * std::numbers::pi * i / CORNERS;
            return middle + radius * glm::dvec2(std::cos(angle), std::sin(angle));
        };
        for (const bool is_halo : {true, false})
            for (int i = 0; i < CORNERS; ++i)
                marks_.strokes.push_back(
                    {corner(i), corner(i + 1), is_halo ? DARK : color, (is_halo ? 6.0 : 4.0) * units_});
    }
    void label(const glm::dvec2& at, const glm::dvec2& anchor, std::string text,
               const std::optional<glm::dvec3>& color = {})
    {
        constexpr double CHARACTER = 7.0;  // about a character's width, in units
        const glm::dvec2 size = units_ * glm::dvec2(CHARACTER * double(text.size()), FONT_UNITS);
        const glm::dvec3 ink = color.value_or(ink_at(at + (0.5 - anchor) * size));
        marks_.labels.push_back({at, anchor, std::move(text), ink});
    }
    /// Returns a colour that stands out from the background, or in slices from the scan's dark air.
    glm::dvec3 ink_at(const glm::dvec2& pixel) const
    {
        return is_light_at(pixel, pane_, model_.volume, model_.session.render.background) ? DARK : LIGHT;
    }

    /// Draws the outline of the brush where it intersects the plane of the pane.
    void brush_ring()
    {
        const BrushSettings& brush = model_.brush();
        const glm::dvec3 center = probe();
        const double radius = brush.radius_voxels * model_.volume.spacing.x;
        const double away = behind_plane(pane_.shot.camera, center);
        const auto at = pixel_of(center);
        if (!at || std::abs(away) >= radius) return;
        const double unit = pixel_size(pane_.shot.camera, pixels_, 1.0);
        if (brush.region == RegionShape::ball)
            return ring(*at, std::sqrt(radius * radius - away * away) / unit, color_);
        const double half = radius / unit;
        closed({*at + glm::dvec2(-half, -half), *at + glm::dvec2(half, -half), *at + glm::dvec2(half, half),
                *at + glm::dvec2(-half, half)},
               color_);
    }

    /// Draws the parts of the trace that cross the slice's plane or lie within a voxel of it.
    void trace_in_slice()
    {
        const Camera& camera = pane_.shot.camera;
        const double unit = pixel_size(camera, pixels_, 1.0);
        const std::bitset<256> drawn = groups_in_pane(model_.session, pane_);
        for (const auto& [number, internode] : model_.trace.internodes()) {
            if (!drawn[internode.group]) continue;
            glm::dvec3 a = model_.trace.node(internode.a).position, b = model_.trace.node(internode.b).position;
            const double from = behind_plane(camera, a), to = behind_plane(camera, b);
            const double reach = std::max(model_.trace.radius_of(internode, 0.5), voxel_along());
            if (std::min(from, to) > reach || std::max(from, to) < -reach) continue;
            if (from != to) {
                const auto share = [&](double depth) { return std::clamp((depth - from) / (to - from), 0.0, 1.0); };
                const double one = share(-reach), other = share(reach);
                const glm::dvec3 begin = glm::mix(a, b, std::min(one, other)),
                                 end = glm::mix(a, b, std::max(one, other));
                a = begin;
                b = end;
            }
            const auto begin = pixel_of(a), end = pixel_of(b);
            if (begin && end && is_near(*begin, *end)) line(*begin, *end, color_of(internode.group), 1.5);
        }
        for (const auto& [number, node] : model_.trace.nodes()) {
            const double away = behind_plane(camera, node.position), reach = std::max(node.radius, 0.5 * voxel_along());
            if (std::abs(away) > reach || !drawn[node.group]) continue;
            const auto at = pixel_of(node.position);
            if (!at || !is_near(*at, *at)) continue;
            const double section = std::sqrt(std::max(node.radius * node.radius - away * away, 0.0)) / unit;
            ring(*at, std::max(section, 2.5 * units_), color_of(node.group));
        }
    }
    glm::dvec3 color_of(uint8_t group) const { return group_of(model_.session.groups, group).color; }
    bool is_near(const glm::dvec2& a, const glm::dvec2& b) const
    {
        return glm::all(glm::greaterThan(glm::max(a, b), glm::dvec2(0.0))) &&
               glm::all(glm::lessThan(glm::min(a, b), glm::dvec2(pixels_)));
    }

    /// Draws the handles of the clip box, larger where the pointer would take hold, and in slices the box's edges.
    void clip_box()
    {
        if (!model_.session.view.cut_box) return;
        const CutBox& cut = model_.session.cut;
        if (is_slice()) closed(box_in_slice(pane_, cut, model_.volume), LIGHT);
        const std::vector<CutHandle> handles = cut_handles(pane_, cut, model_.volume);
        const bool is_below = model_.pointer && model_.pointer->pane == index_;
        const std::optional<CutHandle> held = is_below ? handle_at(handles, model_.pointer->pixel) : std::nullopt;
        for (const CutHandle& handle : handles) knob(handle.at, held == handle, AXES[size_t(handle.axis)]);
    }

    /// Draws the oblique cutting plane and its handles, with a word at the one that the pointer would take hold of.
    void oblique_plane()
    {
        if (!model_.session.view.plane_handles) return;
        const CutBox& cut = model_.session.cut;
        const std::vector<PlaneHandle> handles = plane_handles(pane_, cut, model_.volume);
        const bool is_below = model_.pointer && model_.pointer->pane == index_;
        const auto held = is_below ? handle_at(handles, model_.pointer->pixel) : std::optional<PlaneHandle>();
        for (const auto& [from, to] : plane_lines(pane_, cut, model_.volume)) line(from, to, PLANE);
        for (const PlaneHandle& handle : handles) {
            const bool is_held = held == handle;
            knob(handle.at, is_held, PLANE);
            if (is_held)
                label(handle.at + glm::dvec2(14.0 * units_, 0.0), {0.0, 0.5},
                      handle.kind == PlaneHandle::Kind::move ? "move the plane" : "tilt the plane");
        }
    }

    /// Marks the node or the centre line to which the tools snap now.
    void drawn_tool()
    {
        if (!model_.tool_node && !model_.tool_internode) return;
        if (pane_.kind == Pane::Kind::map || pane_.shot.right_eye) return;
        const auto from = pixel_of(probe()), at = pixel_of(tool());
        if (!from || !at) return;
        line(*from, *at, LIGHT);
        ring(*at, 5.0 * units_, LINK, 2.0);
    }

    /// Draws the link that a new node would get if it were added now, labelled with the link's length.
    void link()
    {
        const std::optional<uint32_t> selected = model_.trace.selection().node();
        if (!selected || model_.tool() != Tool::trace || model_.is_painting || model_.drags_node) return;
        if (pane_.kind == Pane::Kind::map || pane_.shot.right_eye) return;
        const glm::dvec3 from = model_.trace.node(*selected).position, to = tool();
        const auto begin = pixel_of(from), end = pixel_of(to);
        if (!begin || !end || glm::distance(*begin, *end) < 8.0 * units_) return;
        dashed(*begin, *end, LINK);
        label_line(*begin, *end, 0.5 * (*begin + *end), length_in_words(glm::distance(from, to), model_.volume.unit),
                   LINK);
    }

    /// Labels a line of a drawing around `centre`.
    void label_line(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& centre, std::string text,
                    const glm::dvec3& color)
    {
        const auto seen = part_in_pane(from, to, pixels_);
        if (!seen) return;
        const LabelPlace place = place_next_to(seen->first, seen->second, centre, units_);
        marks_.labels.push_back({place.at, place.anchor, std::move(text), color, place.away});
    }

    /// Draws a measurement's sides and points, with `text` next to a side. `number` counts from 1.
    void measurement(const Measurement& measured, size_t number, std::string text, bool is_open)
    {
        const MeasureLines lines = lines_of(measured, pane_, model_.volume, units_, is_open);
        for (const LabelLine& side : lines.sides) {
            if (lines.is_last_open && &side == &lines.sides.back())
                dashed(side.from, side.to, MEASURED);
            else
                line(side.from, side.to, MEASURED, 2.0);
            marks_.lines.push_back(side);
            for (const glm::dvec2& at : {side.from, side.to}) {
                ring(at, 3.5 * units_, MEASURED);
                marks_.lines.push_back(avoided_around(at, 8.0 * units_));
            }
        }
        for (const LabelLine& piece : lines.arc) line(piece.from, piece.to, MEASURED);
        if (!lines.label) return;
        text += lines.note;
        const LabelPlace& place = *lines.label;
        marks_.labels.push_back({place.at, place.anchor, std::move(text), MEASURED, place.away, number});
    }
    void measurements()
    {
        if (pane_.shot.right_eye) return;
        const size_t count = model_.measurements.size();
        for (size_t i = 0; i < count; ++i) {
            const Measurement& each = model_.measurements[i];
            measurement(each, i + 1, label_of(each, i + 1, model_.volume).text(), false);
        }
        if (model_.measuring.empty() || !is_for_screen_) return;
        Measurement begun{{model_.measuring.begin(), model_.measuring.end()}, model_.session.probe.measure, ""};
        const bool leads = model_.tool() == Tool::measure && model_.measuring_to;
        begun.points.push_back(leads ? *model_.measuring_to : begun.points.back());
        const bool is_angle = begun.kind == MeasureKind::angle && begun.points.size() == 3;
        const double length = length_of(begun, model_.volume.spacing);
        measurement(begun, count + 1,
                    is_angle ? value_in_words(begun, model_.volume) : length_in_words(length, model_.volume.unit),
                    true);
    }

    /// Draws a small cross at the pivot of rotation, if the user has picked one.
    void pivot()
    {
        if (!is_main() || model_.session.interaction.pivot != Pivot::picked || !model_.picked_pivot) return;
        const auto at = pixel_of(*model_.picked_pivot);
        if (!at) return;
        const double reach = 7.0 * units_;
        line(*at - glm::dvec2(reach, 0.0), *at + glm::dvec2(reach, 0.0), LIGHT);
        line(*at - glm::dvec2(0.0, reach), *at + glm::dvec2(0.0, reach), LIGHT);
    }

    /// Draws the axes in the lower left corner, in projection: an axis along the line of sight appears short.
    void axes()
    {
        if (pane_.kind == Pane::Kind::map || pane_.shot.right_eye) return;
        const double length = 30.0 * units_;
        const glm::dvec2 middle(length + 16.0 * units_, double(pixels_.y) - length - 16.0 * units_);
        if (pixels_.x < 4.0 * length || pixels_.y < 4.0 * length) return;
        for (size_t axis = 0; axis < 3; ++axis) {
            glm::dvec3 direction(0.0);
            direction[int(axis)] = 1.0;
            const glm::dvec2 way(glm::dot(direction, axes_.right), -glm::dot(direction, axes_.up));
            if (glm::length(way) < 0.05) continue;
            line(middle, middle + length * way, AXES[axis]);
            marks_.lines.push_back({middle, middle + length * way});
            label(middle + (length + 8.0 * units_) * way, {0.5, 0.5}, std::string(1, "xyz"[axis]));
        }
    }

    /// Draws the scale bar in the lower right corner. In perspective, its label states the depth at which it is valid.
    void scale()
    {
        if (pane_.kind == Pane::Kind::map || pane_.shot.right_eye) return;
        const Camera& camera = pane_.shot.camera;
        const bool is_perspective = camera.projection == Camera::Projection::perspective;
        const double unit = pixel_size(camera, pixels_, glm::distance(camera.eye, camera.target));
        const ScaleBar bar = scale_bar(unit, std::min(140.0 * units_, 0.3 * double(pixels_.x)), model_.volume.unit);
        if (bar.pixels < 8.0 * units_) return;
        const glm::dvec2 end(double(pixels_.x) - 16.0 * units_, double(pixels_.y) - 14.0 * units_);
        const glm::dvec2 begin = end - glm::dvec2(bar.pixels, 0.0), rim(units_, 0.0);
        const glm::dvec3 ink = ink_at(0.5 * (begin + end));
        rectangle(begin - rim, end + rim, rim_color(ink), 5.0 * units_);
        rectangle(begin, end, ink, 3.0 * units_);
        marks_.lines.push_back({begin, end});
        label(end - glm::dvec2(0.0, 5.0 * units_), {1.0, 1.0}, bar.text + (is_perspective ? HOLDS_AT_TARGET : ""));
    }

    /// Lists the groups that are painted or traced, in the upper right corner of the first pane. Each colour stands to
    /// the right of the group's name, so that right-aligned names need not be measured.
    void groups()
    {
        if (index_ != 0 || pane_.kind == Pane::Kind::map || pane_.shot.right_eye) return;
        constexpr double LINE = 20.0, SQUARE = 11.0, EDGE = 12.0;
        const std::vector<uint8_t> drawn = drawn_groups(model_.session, model_.voxels_by_group, model_.trace);
        const double free_height = double(pixels_.y) / units_ - 2.0 * EDGE - 90.0;  // axes and scale bar lie below
        const size_t most = size_t(std::max(free_height / LINE, 0.0));
        if (most < 2 && drawn.size() > most) return;
        const size_t named = drawn.size() <= most ? drawn.size() : most - 1;
        glm::dvec2 at(double(pixels_.x) - EDGE * units_, (EDGE + 0.5 * SQUARE) * units_);
        const glm::dvec2 square(SQUARE * units_, 0.0), next(0.0, LINE * units_);
        for (size_t i = 0; i < named; ++i, at += next) {
            const ColorGroup look = group_of(model_.session.groups, drawn[i]);
            const glm::dvec2 rim(units_, 0.0);
            rectangle(at - square - rim, at + rim, DARK, (SQUARE + 2.0) * units_);
            rectangle(at - square, at, look.color, SQUARE * units_);
            label(at - square - glm::dvec2(6.0 * units_, 0.0), {1.0, 0.5}, shortened_name(look.name));
        }
        if (named < drawn.size()) label(at, {1.0, 0.5}, "and " + std::to_string(drawn.size() - named) + " more groups");
    }

    /// Draws the pane's title in its upper left corner; in a slice, also the values under the pointer.
    void title()
    {
        if (model_.panes.size() < 2) return;
        const glm::dvec2 at(8.0 * units_, 6.0 * units_), next(0.0, 20.0 * units_);
        if (!is_slice()) return label(at, {0.0, 0.0}, pane_.name);
        label(at, {0.0, 0.0},
              slice_in_words(pane_.axis, cross_of(model_.session.view.slices, model_.probe_voxel), model_.volume));
        if (!is_for_screen_) return;
        const bool is_here = model_.pointer && model_.pointer->pane == index_;
        if (is_here)
            label(at + next, {0.0, 0.0},
                  place_in_words(model_.reading.voxel, model_.volume) + ": " + value_in_words(model_.reading));
        else if (index_ == 1)
            label(at + next, {0.0, 0.0}, "Ctrl + drag: contrast, Ctrl + wheel: zoom");
    }

    void probe_label()
    {
        const auto at = project(pane_.shot.camera, pixels_, probe());
        if (!at || !is_near(at->pixel, at->pixel) || pane_.shot.right_eye) return;
        const double radius = model_.brush().radius_voxels * model_.volume.spacing.x;
        const double reach = std::max(radius / pixel_size(pane_.shot.camera, pixels_, at->depth), 4.0 * units_);
        std::string text = length_in_words(model_.reading.depth, model_.volume.unit) + " deep";
        if (model_.reading.relevant_share) {
            text = std::to_string(std::lround(100.0 * *model_.reading.relevant_share)) + " % full, " + text;
            meter(at->pixel, reach + 4.0 * units_, *model_.reading.relevant_share);
        }
        // At the right; at the left if there is room only there; else as far right as it is whole. CHARACTER: upper
        // bound of a character's width.
        constexpr double CHARACTER = 8.0;
        const double beside = 0.75 * reach + 6.0 * units_, width = CHARACTER * units_ * double(text.size());
        const glm::dvec2 right = at->pixel + beside;
        const double last = double(pixels_.x) - width;
        if (right.x > last && at->pixel.x - beside >= width)
            label({at->pixel.x - beside, right.y}, {1.0, 0.0}, text);
        else
            label({std::max(std::min(right.x, last), 0.0), right.y}, {0.0, 0.0}, text);
    }
    /// Draws an arc around the probe, clockwise from the top; its angle shows the relevant share of the probe's ball.
    void meter(const glm::dvec2& middle, double radius, double share)
    {
        constexpr int WHOLE = 60;
        const int steps = int(std::lround(share * WHOLE));
        const auto at = [&](int step) {
            const double angle = 2.0 * std::numbers::pi * step / WHOLE;
            return middle + radius * glm::dvec2(std::sin(angle), -std::cos(angle));
        };
        for (int step = 0; step < steps; ++step) line(at(step), at(step + 1), LIGHT, 2.0);
    }

    const Model& model_;
    const Pane& pane_;
    size_t index_;
    double units_;
    bool is_for_screen_;
    glm::uvec2 pixels_;
    CameraAxes axes_;
    glm::dvec3 color_;
    Marks marks_;
};

}  // namespace

bool is_light_at(const glm::dvec2& pixel, const Pane& pane, const VolumeInfo& volume, const glm::dvec4& background)
{
    const bool is_light = background.a < 0.5 || luminance_of(glm::dvec3(background)) > 0.18;
    return is_light && !(pane.kind == Pane::Kind::slice && is_over_scan(pixel, pane, volume));
}

glm::dvec3 rim_color(const glm::dvec3& ink)
{
    return luminance_of(ink) > 0.18 ? DARK : LIGHT;
}

double rim_width(double font_pixels)
{
    return std::max(1.0, std::round(font_pixels / 12.0));
}

void spread_labels(Marks& marks, std::span<const glm::dvec2> text_sizes, const glm::dvec2& margin,
                   const glm::dvec2& pane, LabelMemory* memory)
{
    std::vector<LabelPlace> places;
    std::vector<glm::dvec2> sizes;
    std::vector<size_t> keys;
    for (size_t i = 0; i < marks.labels.size(); ++i) {
        const Label& label = marks.labels[i];
        sizes.push_back(text_sizes[i] + 2.0 * margin);
        // With the margin, the anchor's point moves outwards.
        places.push_back({label.at + (2.0 * label.anchor - 1.0) * margin, label.anchor, label.away});
        keys.push_back(label.key);
    }
    const std::vector<LabelPlace> before = places;
    spread_as_before(places, sizes, pane, marks.lines, keys, memory);
    for (size_t i = 0; i < marks.labels.size(); ++i) {
        Label& label = marks.labels[i];
        if (label.away == glm::dvec2(0.0)) continue;
        label.at = places[i].at - (2.0 * places[i].anchor - 1.0) * margin;
        label.anchor = places[i].anchor;
        const auto leader = leader_of(before[i], places[i], sizes[i]);
        if (!leader) continue;
        const double width = std::max(1.0, sizes[i].y / 16.0);
        marks.strokes.push_back({leader->from, leader->to, rim_color(label.color), 3.0 * width});
        marks.strokes.push_back({leader->from, leader->to, label.color, width});
    }
}

Marks marks_of(const Model& model, const Pane& pane, size_t index, double units, MarksFor purpose)
{
    return Drawing(model, pane, index, units, purpose).all();
}

}  // namespace shvr::ui
