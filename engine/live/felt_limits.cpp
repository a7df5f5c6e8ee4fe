#include "engine/live/felt_limits.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/live/relevance_host.h"

namespace shvr {

namespace {

constexpr double INF = std::numeric_limits<double>::infinity();

/// Adds an interval. Joins it to the last one if no floating-point number lies between the two intervals.
void append(double lower, double upper, IntensityIntervals& intervals)
{
    if (!intervals.empty() && lower <= std::nextafter(intervals.back().second, INF))
        intervals.back().second = std::max(intervals.back().second, upper);
    else
        intervals.emplace_back(lower, upper);
}

void clear_row(int64_t from, int64_t to, uint32_t* words)
{
    for (int64_t x = from; x < to; ++x) words[x / 32] &= ~(1u << (x % 32));
}

void clear_outside(const CutBox& cut, RelevanceBits& bits)
{
    // The centre of a level's voxel i lies at (i + 0.5) times the width of the level's voxels.
    const double width = std::ldexp(1.0, bits.level);
    const Size3 size = bits.box.size();
    const auto first_beyond = [&](const glm::dvec3& plane) {
        const glm::dvec3 index = glm::ceil(plane / width - 0.5) - glm::dvec3(bits.box.lower);
        return Size3(glm::clamp(index, glm::dvec3(0.0), glm::dvec3(size)));
    };
    const Size3 lower = first_beyond(cut.lower), upper = glm::max(lower, first_beyond(cut.upper));
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y) {
            uint32_t* const row = &bits.words[size_t(bits.words_per_row * (y + size.y * z))];
            const bool is_inside = y >= lower.y && y < upper.y && z >= lower.z && z < upper.z;
            clear_row(0, is_inside ? lower.x : size.x, row);
            if (is_inside) clear_row(upper.x, size.x, row);
        }
}

/// Clears the bits of the voxels for whose centre, in voxels of level 0, `is_cut` holds.
template <class IsCut>
void clear_where(const IsCut& is_cut, RelevanceBits& bits)
{
    const Size3 size = bits.box.size();
    const double width = std::ldexp(1.0, bits.level);
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t w = 0; w < bits.words_per_row; ++w) {
                uint32_t& word = bits.words[size_t(w + bits.words_per_row * (y + size.y * z))];
                for (uint32_t left = word; left != 0; left &= left - 1) {
                    const int bit = std::countr_zero(left);
                    if (is_cut((glm::dvec3(bits.box.lower + Size3(32 * w + bit, y, z)) + 0.5) * width))
                        word &= ~(1u << bit);
                }
            }
}

void clear_outside(const DepthLimits& limits, const glm::dvec3& spacing, RelevanceBits& bits)
{
    clear_where(
        [&](const glm::dvec3& voxel) {
            const double depth = glm::dot(voxel * spacing - limits.eye, limits.forward);
            return depth < limits.nearest || depth > limits.farthest;
        },
        bits);
}

void clear_beyond(const glm::dvec4& plane, RelevanceBits& bits)
{
    clear_where([&](const glm::dvec3& voxel) { return glm::dot(plane, glm::dvec4(voxel, 1.0)) > 0.0; }, bits);
}

}  // namespace

bool contains(const IntensityIntervals& intervals, double intensity)
{
    return std::ranges::any_of(intervals,
                               [&](const auto& each) { return each.first <= intensity && intensity <= each.second; });
}

std::bitset<256> drawn_groups(const Groups& groups, bool opaque)
{
    std::bitset<256> drawn;
    drawn.set();
    for (const auto& [group, settings] : groups) {
        const ColorGroup look = group_of(groups, group);
        drawn[group] = look.visible && (!opaque || look.opacity > 0.0);
    }
    return drawn;
}

FeltLimits limits_of_groups(const std::vector<uint8_t>& groups)
{
    FeltLimits limits;
    if (groups.empty()) return limits;
    limits.groups.reset();
    for (const uint8_t group : groups) limits.groups.set(group);
    return limits;
}

IntensityIntervals shown_intensities(const TransferFunction& function, const IntensityWindow& window)
{
    IntensityIntervals shown;
    const std::span<const ControlPoint> points = function.points();
    const auto is_shown = [&](double intensity) { return function.at(intensity).a > 0.0; };
    for (size_t i = 0; i < points.size(); ++i) {
        const double from = points[i].intensity;
        if (is_shown(from)) append(from, from, shown);
        if (i + 1 == points.size() || points[i + 1].intensity == from) continue;
        const double to = points[i + 1].intensity, first = std::nextafter(from, INF), last = std::nextafter(to, -INF);
        if ((points[i].opacity > 0.0 || points[i + 1].opacity > 0.0) && first <= last) append(first, last, shown);
    }
    // Intensities outside the window are shown like the window's nearer end.
    IntensityIntervals clamped;
    if (is_shown(window.lower)) append(-INF, window.lower, clamped);
    for (const auto& [lower, upper] : shown)
        if (lower <= window.upper() && upper >= window.lower)
            append(std::max(lower, window.lower), std::min(upper, window.upper()), clamped);
    if (is_shown(window.upper())) append(window.upper(), INF, clamped);
    return clamped;
}

void limit_to_seen(const Look& look, const Camera& camera, const VolumeInfo& volume, const IntensityWindow& window,
                   double threshold, FeltLimits& limits)
{
    limits.groups &= drawn_groups(look.groups, true);
    IntensityIntervals shown = shown_intensities(look.transfer_function, window);
    const bool shows_all =
        std::ranges::any_of(shown, [&](const auto& each) { return each.first <= threshold && each.second == INF; });
    if (shown.empty() || shown.back().second < threshold)
        limits.groups.reset(0);
    else if (limits.groups[0] && !shows_all)
        limits.unpainted = std::move(shown);
    const bool cuts = glm::any(glm::greaterThan(look.cut.lower, glm::dvec3(0.0))) ||
                      glm::any(glm::lessThan(look.cut.upper, glm::dvec3(volume.size)));
    if (cuts) {
        limits.cut.lower = look.cut.lower;
        limits.cut.upper = look.cut.upper;
    }
    limits.plane = plane_in_voxels(look.cut, volume.size, volume.spacing);
    if (camera.near_distance > 0.0 || camera.far_distance > 0.0)
        limits.depths = DepthLimits{camera.eye, axes_of(camera).forward, camera.near_distance,
                                    camera.far_distance > 0.0 ? camera.far_distance : INF};
}

void apply_limits(const FeltLimits& limits, const glm::dvec3& spacing, const Mask* mask, RelevanceBits& bits)
{
    if (limits.cut != CutBox{}) clear_outside(limits.cut, bits);
    if (limits.plane != glm::dvec4(0.0)) clear_beyond(limits.plane, bits);
    if (limits.depths) clear_outside(*limits.depths, spacing, bits);
    if (limits.groups.all()) return;
    if (mask)
        limit_to_groups(*mask, limits.groups, bits);
    else if (!limits.groups[0])
        std::ranges::fill(bits.words, 0u);
}

}  // namespace shvr
