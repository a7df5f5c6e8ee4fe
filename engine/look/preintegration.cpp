#include "engine/look/preintegration.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "shaders/raycast.h"

namespace shvr {

namespace {

/// Upper limit of extinction per reference length, which stands for opacity 1. Even the smallest part of the shortest
/// step is opaque at this limit, yet differences between integrals of extinction are still exact to 1e-8.
constexpr double OPAQUE = 1e6;
constexpr uint32_t MAX_PARTS = 16;

double extinction_of(double opacity)
{
    return opacity >= 1.0 ? OPAQUE : std::min(-std::log1p(-opacity), OPAQUE);
}

/// Interpolates linearly. Returns exactly `from` if `from` and `to` are equal.
double between(double from, double to, double share)
{
    return std::min(from + (to - from) * share, 1.0);
}

/// Returns the mean of -ln(1 - o) for opacities o that change linearly from `from` to `to`.
double mean_extinction(double from, double to)
{
    const double a = 1.0 - from, b = 1.0 - to;
    // For nearly equal opacities, the closed form loses digits; there, Simpson's rule has a relative error below 1e-13.
    if (std::abs(a - b) <= 1e-3 * std::max(a, b))
        return (extinction_of(from) + 4.0 * extinction_of(0.5 * (from + to)) + extinction_of(to)) / 6.0;
    const auto integral = [](double u) { return u > 0.0 ? u - u * std::log(u) : 0.0; };
    return (integral(a) - integral(b)) / (a - b);
}

/// For each entry, the integrals of extinction, and of extinction times colour, over density up to that entry.
struct Integrals {
    std::vector<double> density, extinction;
    std::vector<glm::dvec3> light;
};

Integrals integrals_of(const TransferFunction& function, const Samples& samples)
{
    const uint32_t side = samples.entries;
    Integrals sums{.density = std::vector<double>(side), .extinction = {0.0}, .light = {glm::dvec3(0.0)}};
    for (uint32_t k = 0; k < side; ++k) sums.density[k] = samples.at(k);

    double extinction = 0.0;
    glm::dvec3 light(0.0);
    const std::span<const ControlPoint> points = function.points();
    uint32_t next = 1;
    for (size_t piece = 0; piece + 1 < points.size(); ++piece) {
        const ControlPoint &p = points[piece], &q = points[piece + 1];
        const bool is_opaque = p.opacity >= 1.0 && q.opacity >= 1.0;
        const auto share = [&](double x) { return (x - p.intensity) / (q.intensity - p.intensity); };
        const double piece_end = std::min(q.intensity, samples.upper);
        for (double x = std::max(p.intensity, samples.lower); x < piece_end;) {
            const double end = std::min(piece_end, sums.density[next]);
            const double from = share(x), to = share(end);
            const double o0 = between(p.opacity, q.opacity, from), o1 = between(p.opacity, q.opacity, to);
            const double s0 = extinction_of(o0), middle = extinction_of(0.5 * (o0 + o1)), s1 = extinction_of(o1);
            const double sum = s0 + 4.0 * middle + s1;
            const double own = is_opaque ? 0.0 : (end - x) * mean_extinction(o0, o1);
            // Mixes the colours at this part's centre of extinction, which Simpson's rule finds accurately enough.
            const double back = sum > 0.0 ? (2.0 * middle + s1) / sum : 0.5;
            extinction += own;
            light += own * glm::mix(p.color, q.color, glm::mix(from, to, back));
            if (end == sums.density[next]) {
                sums.extinction.push_back(extinction);
                sums.light.push_back(light);
                next = std::min(next + 1, side - 1);
            }
            x = end;
        }
    }
    sums.extinction.resize(side, extinction);  // entries that are missing due to rounding or zero width
    sums.light.resize(side, light);
    return sums;
}

double depth_between(const Integrals& sums, double step, uint32_t front, uint32_t back)
{
    const double extinction = std::abs(sums.extinction[back] - sums.extinction[front]);
    return step / std::abs(sums.density[back] - sums.density[front]) * extinction;
}

glm::dvec4 step_between(const Integrals& sums, double step, uint32_t front, uint32_t back)
{
    const uint32_t apart = std::max(front, back) - std::min(front, back), parts = std::min(apart, MAX_PARTS);
    const double scale = step / std::abs(sums.density[back] - sums.density[front]);
    const auto boundary = [&](uint32_t part) {
        const uint32_t along = apart * part / parts;
        return front < back ? front + along : front - along;
    };
    glm::dvec3 light(0.0);
    double through = 1.0;
    for (uint32_t part = 0; part < parts; ++part) {
        const uint32_t a = boundary(part), b = boundary(part + 1);
        const double extinction = std::abs(sums.extinction[b] - sums.extinction[a]);
        if (extinction <= 0.0) continue;
        const glm::dvec3 color = glm::abs(sums.light[b] - sums.light[a]) / extinction;
        const double opacity = -std::expm1(-scale * extinction);
        light += through * opacity * color;
        through *= 1.0 - opacity;
    }
    // For small opacities, 1 - through loses digits, so the opacity is computed from the optical depth.
    return glm::dvec4(light, -std::expm1(-depth_between(sums, step, front, back)));
}

}  // namespace

BakedTable preintegrated_table(const TransferFunction& function, double step_voxels, const Samples& samples)
{
    const uint32_t side = samples.entries;
    SHVR_CHECK(side >= 2 && step_voxels > 0.0, side, " ", step_voxels);
    const size_t entries = size_t(side) * side;
    BakedTable table{std::vector<glm::vec4>(entries, glm::vec4(0.0f)), std::vector<float>(entries, 0.0f)};
    if (function.draws_nothing()) return table;
    const Integrals sums = integrals_of(function, samples);
    for (uint32_t back = 0; back < side; ++back)
        for (uint32_t front = 0; front < side; ++front) {
            glm::dvec4 look;
            double depth;
            if (front == back) {
                const glm::dvec4 here = function.at(sums.density[front]);
                const double opacity = opacity_of_step(here.a, step_voxels);
                look = glm::dvec4(opacity * glm::dvec3(here), opacity);
                depth = depth_of_step(here.a, step_voxels);
            } else {
                look = step_between(sums, step_voxels, front, back);
                depth = depth_between(sums, step_voxels, front, back);
            }
            const size_t entry = size_t(back) * side + front;
            table.looks[entry] = glm::vec4(look);
            table.depths[entry] = float(std::min(depth, double(gpu::OPAQUE_DEPTH)));
        }
    return table;
}

std::vector<uint32_t> visible_intervals_of_steps(std::span<const glm::vec4> table, const Samples& samples,
                                                 std::span<const OpaqueInterval> opaque)
{
    const uint32_t side = samples.entries;
    size_t next = 0;  // the first opaque interval that ends at or after this sample
    const auto opacity = [&](uint32_t front, uint32_t back) { return table[size_t(back) * side + front].a; };
    std::vector<uint32_t> visible_before(side, 0);
    for (uint32_t k = 1; k < side; ++k) {
        while (next < opaque.size() && opaque[next].upper < samples.at(k - 1)) ++next;
        const bool is_visible = opacity(k - 1, k - 1) > 0.0f || opacity(k - 1, k) > 0.0f || opacity(k, k) > 0.0f ||
                                (next < opaque.size() && opaque[next].lower <= samples.at(k));
        visible_before[k] = visible_before[k - 1] + uint32_t(is_visible);
    }
    return visible_before;
}

}  // namespace shvr
