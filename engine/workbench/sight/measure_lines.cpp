#include "engine/workbench/sight/measure_lines.h"

#include <algorithm>
#include <cmath>

#include "engine/look/camera_motion.h"
#include "engine/workbench/sight/hits.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

/// Lines between points of the volume, as a pane shows them.
class InPane {
public:
    InPane(const Pane& pane, const VolumeInfo& volume) : pane_(pane), pixels_(pane.pixels()), spacing_(volume.spacing)
    {}

    std::optional<glm::dvec2> pixel_of(const glm::dvec3& point) const
    {
        const auto at = project(pane_.shot.camera, pixels_, point);
        return at ? std::optional(at->pixel) : std::nullopt;
    }
    /// Returns the part of a line in front of the camera; null: none.
    std::optional<LabelLine> line_of(glm::dvec3 a, glm::dvec3 b) const
    {
        constexpr double NEAREST = 1e-3;  // depth, of the target's
        const Camera& camera = pane_.shot.camera;
        if (camera.projection == Camera::Projection::perspective) {
            const glm::dvec3 forward = axes_of(camera).forward;
            const double nearest = NEAREST * glm::distance(camera.eye, camera.target);
            const double from = glm::dot(a - camera.eye, forward) - nearest;
            const double to = glm::dot(b - camera.eye, forward) - nearest;
            if (from <= 0.0 && to <= 0.0) return std::nullopt;
            if (from < 0.0) a = glm::mix(a, b, from / (from - to));
            if (to < 0.0) b = glm::mix(b, a, to / (to - from));
        }
        const auto from = pixel_of(a), to = pixel_of(b);
        return from && to ? std::optional(LabelLine{*from, *to}) : std::nullopt;
    }
    /// Whether the pane shows the line; a slice, if it crosses the plane or comes within a voxel of it.
    bool shows(const glm::dvec3& a, const glm::dvec3& b) const
    {
        if (pane_.kind != Pane::Kind::slice) return true;
        const double from = behind_plane(pane_.shot.camera, a), to = behind_plane(pane_.shot.camera, b);
        return from * to <= 0.0 || std::min(std::abs(from), std::abs(to)) <= voxel();
    }
    /// Whether a line of a slice ends more than a voxel away from it.
    bool leaves(const glm::dvec3& a, const glm::dvec3& b) const
    {
        if (pane_.kind != Pane::Kind::slice) return false;
        const double from = behind_plane(pane_.shot.camera, a), to = behind_plane(pane_.shot.camera, b);
        return std::max(std::abs(from), std::abs(to)) > voxel();
    }
    std::vector<LabelLine> arc_of(const Measurement& measured) const;

private:
    double voxel() const { return spacing_[std::clamp(pane_.axis, 0, 2)]; }

    const Pane& pane_;
    glm::uvec2 pixels_;
    glm::dvec3 spacing_;
};

/// Returns an angle's arc between its sides.
std::vector<LabelLine> InPane::arc_of(const Measurement& measured) const
{
    constexpr int PARTS = 24;
    constexpr double SHARE = 0.3;  // radius of the arc, of the shorter side
    constexpr double MIN_DEGREES = 0.1;
    const glm::dvec3 vertex = measured.points[1] * spacing_;
    const glm::dvec3 a = measured.points[0] * spacing_ - vertex, b = measured.points[2] * spacing_ - vertex;
    const auto angle = angle_of(measured, spacing_);
    if (!angle || *angle < MIN_DEGREES || *angle > 180.0 - MIN_DEGREES) return {};
    if (!shows(vertex, vertex + a) || !shows(vertex, vertex + b)) return {};
    const glm::dvec3 along = glm::normalize(a), across = glm::normalize(b - glm::dot(b, along) * along);
    const double radius = SHARE * std::min(glm::length(a), glm::length(b));
    std::vector<LabelLine> arc;
    std::optional<glm::dvec2> before;
    for (int i = 0; i <= PARTS; ++i) {
        const double turned = glm::radians(*angle) * i / PARTS;
        const auto at = pixel_of(vertex + radius * (std::cos(turned) * along + std::sin(turned) * across));
        if (before && at) arc.push_back({*before, *at});
        before = at;
    }
    return arc;
}

}  // namespace

MeasureLines lines_of(const Measurement& measured, const Pane& pane, const VolumeInfo& volume, double units,
                      bool is_open)
{
    const InPane in_pane(pane, volume);
    const std::vector<glm::dvec3>& points = measured.points;
    MeasureLines lines;
    std::optional<LabelLine> labelled;
    glm::dvec2 sum(0.0);
    for (size_t i = 1; i < points.size(); ++i) {
        const glm::dvec3 begin = points[i - 1] * volume.spacing, end = points[i] * volume.spacing;
        const auto side = in_pane.line_of(begin, end);
        if (!side || !in_pane.shows(begin, end)) continue;
        lines.sides.push_back(*side);
        if (in_pane.leaves(begin, end)) lines.note = " (through the slice)";
        lines.is_last_open = is_open && i + 1 == points.size();
        if (part_in_pane(side->from, side->to, pane.pixels()) && (!labelled || i == points.size() / 2)) labelled = side;
        sum += side->from + side->to;
    }
    if (lines.sides.size() + 1 < points.size()) lines.note = " (seen in part)";
    if (!labelled) return lines;
    if (measured.kind == MeasureKind::angle && points.size() == 3) lines.arc = in_pane.arc_of(measured);
    const auto seen = part_in_pane(labelled->from, labelled->to, pane.pixels());
    lines.label = place_next_to(seen->first, seen->second, sum / (2.0 * double(lines.sides.size())), units);
    return lines;
}

MeasureLabel label_of(const Measurement& measured, size_t number, const VolumeInfo& volume)
{
    std::string name = shortened_name(name_of(measured, number));
    std::ranges::replace_if(
        name, [](char c) { return uint8_t(c) < ' '; }, ' ');  // line ends
    return {std::move(name), value_in_words(measured, volume)};
}

}  // namespace shvr::ui
