#include "engine/workbench/curves/transfer_curve.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace shvr::ui {

float CurveAxes::x_of(double intensity) const
{
    const double share = std::clamp((intensity - lower) / (upper - lower), -1.0, 2.0);
    return begin.x + float(share) * (end.x - begin.x);
}

float CurveAxes::y_of(double opacity) const
{
    return end.y - float(std::sqrt(opacity)) * (end.y - begin.y);
}

double CurveAxes::intensity_at(float x) const
{
    const double share = double(x - begin.x) / double(end.x - begin.x);
    return lower + std::clamp(share, 0.0, 1.0) * (upper - lower);
}

double CurveAxes::opacity_at(float y) const
{
    const double root = std::clamp(double(end.y - y) / double(end.y - begin.y), 0.0, 1.0);
    return root * root;
}

glm::vec2 CurveAxes::place_of(const ControlPoint& point) const
{
    return {x_of(point.intensity), y_of(point.opacity)};
}

CurveRange range_of_curve(const TransferFunction& function, double lowest, double highest)
{
    const bool has_points = !function.points().empty();
    CurveRange range{has_points ? std::min(lowest, function.lower()) : lowest,
                     has_points ? std::max(highest, function.upper()) : highest};
    if (!(range.upper > range.lower)) range.upper = range.lower + std::max(1.0, std::abs(range.lower));
    return range;
}

TransferFunction TransferCurve::function() const
{
    Points points = points_;
    for (ControlPoint& point : points) {
        point.intensity = std::clamp(point.intensity, -double(FLT_MAX), double(FLT_MAX));
        point.opacity = std::clamp(point.opacity, 0.0, 1.0);
        point.color = glm::clamp(point.color, glm::dvec3(0.0), glm::dvec3(1.0));
    }
    return TransferFunction(std::move(points));
}

TransferCurve::Found TransferCurve::under(const CurveAxes& axes, const glm::vec2& mouse, const Lines& lines,
                                          const Reach& reach) const
{
    Found found;
    float nearest = reach.pixels;
    for (size_t i = 0; i < points_.size(); ++i) {
        const float distance = glm::distance(axes.place_of(points_[i]), mouse);
        if (distance <= nearest) found = {Grip::point, i}, nearest = distance;
    }
    if (found.grip == Grip::point) return found;
    const float row = (mouse.y - axes.begin.y) / reach.label;
    const bool is_paint_row = row > 0.0f && row <= 1.0f, is_felt_row = row > 1.0f && row <= 2.0f;
    const auto is_in = [&](const glm::vec2& word) { return mouse.x >= word.x && mouse.x < word.y; };
    if (is_paint_row && is_in(lines.paint_word)) return {Grip::paint_threshold, 0};
    if (is_felt_row && is_in(lines.haptic_word)) return {Grip::haptic_threshold, 0};
    const float to_paint = std::abs(axes.x_of(lines.paint_threshold) - mouse.x);
    const float to_felt = std::abs(axes.x_of(lines.haptic_threshold) - mouse.x);
    if (std::min(to_paint, to_felt) > 0.6f * reach.pixels) return found;
    const bool is_paint = to_paint == to_felt ? !is_felt_row : to_paint < to_felt;
    return {is_paint ? Grip::paint_threshold : Grip::haptic_threshold, 0};
}

size_t TransferCurve::add(double intensity, double opacity)
{
    const TransferFunction before(points_);
    ControlPoint added{.intensity = intensity, .opacity = opacity};
    // The function has no colour beyond its end points, so a point added there takes the colour of the end point.
    if (!points_.empty()) added.color = glm::dvec3(before.at(std::clamp(intensity, before.lower(), before.upper())));
    const auto after = std::ranges::upper_bound(points_, intensity, {}, &ControlPoint::intensity);
    const auto index = size_t(after - points_.begin());
    points_.insert(after, added);
    return index;
}

size_t TransferCurve::remove(size_t point)
{
    if (points_.size() <= 2) return point;
    points_.erase(points_.begin() + std::ptrdiff_t(point));
    return std::min(point, points_.size() - 1);
}

double TransferCurve::held_between_neighbors(size_t point, double intensity) const
{
    const double lower = point > 0 ? points_[point - 1].intensity : -double(FLT_MAX);
    const double upper = point + 1 < points_.size() ? points_[point + 1].intensity : double(FLT_MAX);
    return std::clamp(intensity, lower, upper);
}

void TransferCurve::move(size_t point, double intensity, double opacity)
{
    points_[point].intensity = held_between_neighbors(point, intensity);
    points_[point].opacity = opacity;
}

double TransferCurve::shift_all(double by, double lowest, double highest)
{
    if (points_.empty()) return 0.0;
    const double least = lowest - points_.back().intensity, most = highest - points_.front().intensity;
    const double held = std::clamp(by, std::min(least, 0.0), std::max(most, 0.0));
    for (ControlPoint& point : points_) point.intensity += held;
    return held;
}

double wheel_shift(double notches, const CurveRange& range, bool is_slow, bool is_whole)
{
    const double notch = (range.upper - range.lower) * (is_slow ? 0.001 : 0.01);
    const double step = is_whole ? std::max(1.0, std::round(notch)) : notch;
    return notches * step;
}

}  // namespace shvr::ui
