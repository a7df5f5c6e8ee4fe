#include "engine/look/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "shaders/raycast.h"

namespace shvr {
namespace {

void check_share(double value, size_t point, const char* what)
{
    if (!(value >= 0.0 && value <= 1.0))
        fail("transfer function: ", what, " of point ", point, " is ", value, "; expected 0 to 1");
}

void check_point(const ControlPoint& point, size_t index)
{
    constexpr double LARGEST = std::numeric_limits<float>::max();
    if (!(std::abs(point.intensity) <= LARGEST))
        fail("transfer function: intensity of point ", index, " is ", point.intensity,
             "; expected a number in the range of float32");
    for (int channel = 0; channel < 3; ++channel) check_share(point.color[channel], index, "colour");
    check_share(point.opacity, index, "opacity");
}

glm::dvec4 value_of(const ControlPoint& point)
{
    return {point.color, point.opacity};
}

}  // namespace

TransferFunction::TransferFunction(std::vector<ControlPoint> points) : points_(std::move(points))
{
    for (size_t index = 0; index < points_.size(); ++index) check_point(points_[index], index);
    std::ranges::stable_sort(points_, {}, &ControlPoint::intensity);
}

bool TransferFunction::draws_nothing() const
{
    return !(lower() < upper()) || std::ranges::all_of(
                                       points_, [](double opacity) { return opacity <= 0.0; }, &ControlPoint::opacity);
}

glm::dvec4 TransferFunction::at(double intensity) const
{
    if (!(lower() < upper()) || !(intensity >= lower() && intensity <= upper())) return glm::dvec4(0.0);
    const auto next = std::ranges::upper_bound(points_, intensity, {}, &ControlPoint::intensity);
    const ControlPoint& before = *std::prev(next);
    if (next == points_.end() || before.intensity == intensity) return value_of(before);
    const double share = (intensity - before.intensity) / (next->intensity - before.intensity);
    return value_of(before) + (value_of(*next) - value_of(before)) * share;
}

double opacity_of_step(double opacity, double step_voxels)
{
    SHVR_CHECK(step_voxels >= 0.0 && !std::isnan(opacity), step_voxels, " ", opacity);
    if (opacity <= 0.0 || step_voxels == 0.0) return 0.0;
    if (opacity >= 1.0) return 1.0;
    return -std::expm1(step_voxels * std::log1p(-opacity));
}

double depth_of_step(double opacity, double step_voxels)
{
    if (opacity <= 0.0 || step_voxels == 0.0) return 0.0;
    return opacity >= 1.0 ? std::numeric_limits<double>::infinity() : -step_voxels * std::log1p(-opacity);
}

double Samples::at(uint32_t entry) const
{
    // Entries at whole intensities must be exact, so this multiplies before it divides, and returns `upper` itself for
    // the last entry.
    return entry + 1 == entries ? upper : lower + (upper - lower) * entry / (entries - 1);
}

Samples whole_range(const TransferFunction& function, uint32_t entries)
{
    return {function.lower(), function.upper(), entries};
}

BakedTable bake_table(const TransferFunction& function, double step_voxels, const Samples& samples)
{
    SHVR_CHECK(samples.entries >= 2, samples.entries);
    BakedTable table{std::vector<glm::vec4>(samples.entries), std::vector<float>(samples.entries)};
    for (uint32_t entry = 0; entry < samples.entries; ++entry) {
        const glm::dvec4 value = function.at(samples.at(entry));
        const double depth = depth_of_step(value.a, step_voxels);
        table.looks[entry] = glm::vec4(glm::dvec4(glm::dvec3(value), -std::expm1(-depth)));
        table.depths[entry] = float(std::min(depth, double(gpu::OPAQUE_DEPTH)));
    }
    return table;
}

std::vector<OpaqueInterval> opaque_intervals(const TransferFunction& function)
{
    std::vector<OpaqueInterval> found;
    if (function.draws_nothing()) return found;
    const auto is_touched = [&](double intensity) { return !found.empty() && found.back().upper == intensity; };
    const std::span<const ControlPoint> points = function.points();
    for (size_t i = 0; i < points.size(); ++i) {
        const ControlPoint& point = points[i];
        if (point.opacity < 1.0) continue;
        const bool holds = i + 1 == points.size() || points[i + 1].intensity > point.intensity;
        if (!holds) continue;
        if (i + 1 < points.size() && points[i + 1].opacity >= 1.0)
            found.push_back({point.intensity, points[i + 1].intensity, point.color, points[i + 1].color});
        else if (!is_touched(point.intensity))
            found.push_back({point.intensity, point.intensity, point.color, point.color});
    }
    return found;
}

std::vector<uint32_t> visible_intervals(const TransferFunction& function, const Samples& samples)
{
    std::vector<uint32_t> visible_before(samples.entries, 0);
    const std::span<const ControlPoint> points = function.points();
    size_t line = 0;  // the first interval between two points that ends at or after the sample
    for (uint32_t k = 1; k < samples.entries; ++k) {
        const double lower = samples.at(k - 1), upper = samples.at(k);
        while (line + 2 < points.size() && points[line + 1].intensity < lower) ++line;
        bool is_visible = false;
        for (size_t i = line; i + 1 < points.size() && points[i].intensity <= upper; ++i)
            is_visible = is_visible ||
                         (points[i + 1].intensity >= lower && (points[i].opacity > 0.0 || points[i + 1].opacity > 0.0));
        visible_before[k] = visible_before[k - 1] + uint32_t(is_visible);
    }
    return visible_before;
}

std::vector<uint32_t> visible_intervals(std::span<const glm::vec4> table)
{
    std::vector<uint32_t> visible_before(table.size(), 0);
    for (size_t entry = 1; entry < table.size(); ++entry) {
        const bool is_visible = table[entry - 1].a > 0.0f || table[entry].a > 0.0f;
        visible_before[entry] = visible_before[entry - 1] + (is_visible ? 1u : 0u);
    }
    return visible_before;
}

}  // namespace shvr
