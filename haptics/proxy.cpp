#include "haptics/proxy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

namespace shvr {
namespace {

/// Integrals of 1, t and t^2 along one chord, where t = x - centre.x.
struct Moments {
    double length = 0.0, first = 0.0, second = 0.0;
};

struct Chord {
    double lower = 0.0, upper = 0.0;  ///< chord in voxels from the patch's lower corner, clipped to the patch
};

/// Integrates runs of set bits word by word: a run that spans two words is treated as two adjacent intervals. Only the
/// ends of the chord are fractions of a voxel. Inlined, since calls would make a tick 5 to 15 % slower.
[[gnu::always_inline]] inline Moments integrate_row(const uint32_t* words, const Chord& chord, double centre,
                                                    double spacing)
{
    Moments moments;
    const auto last_voxel = int32_t(std::ceil(chord.upper)) - 1;
    for (int32_t voxel = int32_t(chord.lower); voxel <= last_voxel;) {
        const int32_t word_start = voxel & ~31, word_last = std::min(word_start + 31, last_voxel);
        uint32_t bits =
            words[word_start / 32] & (~0u << (voxel - word_start)) & (~0u >> (31 - (word_last - word_start)));
        while (bits != 0) {
            const int first = std::countr_zero(bits), count = std::countr_one(bits >> first);
            const double run_lower = double(word_start + first), run_upper = double(word_start + first + count);
            const double a = (std::max(run_lower, chord.lower) - centre) * spacing;
            const double b = (std::min(run_upper, chord.upper) - centre) * spacing;
            moments.length += b - a;
            moments.first += 0.5 * (b * b - a * a);
            moments.second += (b * b * b - a * a * a) / 3.0;
            // Adding the lowest set bit carries through the lowest run; the & then clears the run and the carried bit.
            bits &= bits + (bits & (0u - bits));
        }
        voxel = word_last + 1;
    }
    return moments;
}

/// Half-open range of the rows along one axis that may intersect the ball.
struct RowRange {
    int32_t begin = 0, end = 0;
};
RowRange rows_within(double centre, double reach, int32_t count)
{
    const double begin = std::clamp(std::floor(centre - reach), 0.0, double(count));
    const double end = std::clamp(std::ceil(centre + reach), 0.0, double(count));
    return {int32_t(begin), int32_t(end)};
}

/// Positions and weights of the integration lines across a row of voxels, the same along y and z. The positions are
/// fixed relative to the voxels, not to the ball: only then are the sums of the potential law exact gradients.
struct RowRule {
    std::array<double, 3> places{};   ///< voxels from the row's lower side
    std::array<double, 3> weights{};  ///< with a sum of 1
    size_t count = 1;
};
constexpr RowRule MIDDLE{{0.5}, {1.0}, 1};
constexpr RowRule GAUSS_2{{0.21132486540518713, 0.78867513459481287}, {0.5, 0.5}, 2};
constexpr RowRule GAUSS_3{{0.11270166537925831, 0.5, 0.88729833462074169}, {5.0 / 18, 8.0 / 18, 5.0 / 18}, 3};
/// Small balls need more lines per row, but have fewer rows. Measured on rods with the mean law: error of the proxy and
/// RMS second difference along a slow path, in % of the radius (goals: 0.4 and 0.06 at 6 voxels, 0.2 and 0.02 from 12
/// voxels up):
///     radius   middle            Gauss 2           Gauss 3
///     6        0.47    0.072     0.14    0.035     0.06    0.024
///     12       0.10    0.018     0.04    0.009     0.02    0.006
///     24       0.03    0.004     0.01    0.002
const RowRule& rule_for(double radius_voxels)
{
    return radius_voxels < 7.5 ? GAUSS_3 : radius_voxels < 14.5 ? GAUSS_2 : MIDDLE;
}

bool is_empty(const uint32_t* words, int32_t count)
{
    return std::all_of(words, words + count, [](uint32_t word) { return word == 0; });
}

/// Maps three numbers in 0 ... 1 to a point in the unit ball. Uniform numbers give points of uniform density.
glm::dvec3 point_of(double of_volume, double of_height, double of_turn)
{
    const double r = std::cbrt(of_volume), z = 2.0 * of_height - 1.0;
    const double phi = 2.0 * std::numbers::pi * of_turn, across = std::sqrt(1.0 - z * z);
    return r * glm::dvec3(across * std::cos(phi), across * std::sin(phi), z);
}

/// `IS_CUT`: part of the ball lies beyond `reach`. For a whole ball, the common case, false is a tenth faster.
template <bool IS_CUT>
BallIntegrals integrate_part(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                             const glm::dvec3& reach) noexcept
{
    BallIntegrals ball;
    const glm::dvec3 spacing = patch.spacing;
    const glm::dvec3 c = centre / spacing - glm::dvec3(patch.origin);  // voxels from the patch's lower corner
    if (!patch.is_well_formed() || !(radius > 0.0) || !std::isfinite(c.x + c.y + c.z + radius)) return ball;
    const RowRule& rule = rule_for(radius / std::max(spacing.y, spacing.z));

    const auto add_line = [&](const uint32_t* words, double dy, double dz, double weight) {
        const double rest = radius * radius - dy * dy - dz * dz;
        if (rest <= 0.0) return;
        const double half = (IS_CUT ? std::min(std::sqrt(rest), reach.x) : std::sqrt(rest)) / spacing.x;
        const Chord chord{std::max(c.x - half, 0.0), std::min(c.x + half, double(patch.size.x))};
        if (chord.lower >= chord.upper) return;
        const Moments moments = integrate_row(words, chord, c.x, spacing.x);
        ball.volume += weight * moments.length;
        ball.first += weight * glm::dvec3(moments.first, dy * moments.length, dz * moments.length);
        ball.second += weight * (moments.second + (dy * dy + dz * dz) * moments.length);
    };

    // A line stands for the full width of a voxel, so at a cut the line's weight falls from 1 to 0 over that width.
    const auto weight_at = [&](int axis, double away) {
        if (!IS_CUT || reach[axis] >= radius) return 1.0;
        return std::clamp((reach[axis] - std::abs(away)) / spacing[axis] + 0.5, 0.0, 1.0);
    };

    const RowRange slices =
        rows_within(c.z, (IS_CUT ? std::min(radius, reach.z + spacing.z) : radius) / spacing.z, patch.size.z);
    for (int32_t z = slices.begin; z < slices.end; ++z) {
        // The largest disc of the ball in this slice, at the z nearest to the ball's centre, bounds the chords.
        const double nearest = (std::clamp(c.z, double(z), double(z + 1)) - c.z) * spacing.z;
        const double disc = std::sqrt(std::max(radius * radius - nearest * nearest, 0.0));
        const RowRange rows =
            rows_within(c.y, (IS_CUT ? std::min(disc, reach.y + spacing.y) : disc) / spacing.y, patch.size.y);
        for (int32_t y = rows.begin; y < rows.end; ++y) {
            const size_t row = size_t(patch.words_per_row) * (size_t(y) + size_t(patch.size.y) * size_t(z));
            const uint32_t* words = &patch.words[row];
            if (is_empty(words, patch.words_per_row)) continue;
            for (size_t j = 0; j < rule.count; ++j) {
                const double dz = (z + rule.places[j] - c.z) * spacing.z;
                const double weight = rule.weights[j] * weight_at(2, dz);
                for (size_t i = 0; i < rule.count; ++i) {
                    const double dy = (y + rule.places[i] - c.y) * spacing.y;
                    add_line(words, dy, dz, rule.weights[i] * weight * weight_at(1, dy));
                }
            }
        }
    }
    const double row_area = spacing.y * spacing.z;
    return {ball.volume * row_area, ball.first * row_area, ball.second * row_area};
}

}  // namespace

BallIntegrals integrate(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                        const glm::dvec3& reach) noexcept
{
    const bool is_cut = glm::any(glm::lessThan(reach, glm::dvec3(radius)));
    return (is_cut ? integrate_part<true> : integrate_part<false>)(patch, centre, radius, reach);
}

std::vector<glm::dvec3> random_points(int count)
{
    std::mt19937 random(3000);
    const auto uniform = [&] { return (double(random()) + 0.5) / 4294967296.0; };
    std::vector<glm::dvec3> points;
    for (int i = 0; i < count; ++i) {
        const double volume = uniform(), height = uniform(), turn = uniform();
        points.push_back(point_of(volume, height, turn));
    }
    return points;
}

std::vector<glm::dvec3> even_points(int count)
{
    constexpr double PLASTIC = 1.3247179572447460;
    const auto share = [](double x) { return x - std::floor(x); };
    std::vector<glm::dvec3> points;
    for (int i = 0; i < count; ++i)
        points.push_back(point_of((i + 0.5) / count, share(0.5 + i / PLASTIC), share(0.5 + i / (PLASTIC * PLASTIC))));
    return points;
}

namespace {
/// Initialized before main(), so that no tick spends time on drawing the points.
const std::vector<glm::dvec3> THESIS_POINTS = random_points(SAMPLE_POINTS);
}  // namespace

Proxy find_sampled_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                         std::span<const glm::dvec3> points) noexcept
{
    const glm::dvec3 c = centre / patch.spacing - glm::dvec3(patch.origin), reach = radius / patch.spacing;
    if (!patch.is_well_formed() || !(radius > 0.0) || !std::isfinite(c.x + c.y + c.z + radius)) return {};
    const glm::dvec3 size(patch.size);
    const KnownPart known = patch.known_part(centre, radius);
    if (!(known.share > 0.0)) return {};
    const glm::dvec3 part = known.reach / radius;
    glm::dvec3 sum(0.0);
    int count = 0;
    for (const glm::dvec3& point : points) {
        if (glm::any(glm::greaterThan(glm::abs(point), part))) continue;
        const glm::dvec3 at = c + reach * point;
        if (!glm::all(glm::greaterThanEqual(at, glm::dvec3(0.0))) || !glm::all(glm::lessThan(at, size))) continue;
        const glm::ivec3 voxel(at);
        if (!(patch.row_word(voxel.x / 32, voxel.y, voxel.z) >> (voxel.x % 32) & 1u)) continue;
        sum += point;
        ++count;
    }
    if (count == 0) return {};
    const glm::dvec3 mean = radius * sum / double(count);
    return {true, known.share * mean, mean, std::min(double(count) / (known.share * double(points.size())), 1.0)};
}

namespace {

/// Returns the number by which the integral of a - p is divided. Only for the laws that use integrals.
double denominator_of(ProxyLaw law, const BallIntegrals& ball, double radius, double whole) noexcept
{
    switch (law) {
        case ProxyLaw::mean:
        case ProxyLaw::thesis: return ball.volume;
        case ProxyLaw::potential: {
            // The weight 1 - |a - p|^2 / r^2 is 0 at the rim, so the chords' ends contribute nothing to the derivative
            // of the sum of weights: it is exactly 2 / r^2 times `first`, even for a finite number of rows.
            const double weighted = std::max(ball.volume - ball.second / (radius * radius), 0.0);
            return weighted + POTENTIAL_FLOOR * whole;
        }
    }
    return ball.volume;
}

}  // namespace

Proxy find_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius, ProxyLaw law) noexcept
{
    if (law == ProxyLaw::thesis) return find_sampled_proxy(patch, centre, radius, THESIS_POINTS);
    const KnownPart known = patch.known_part(centre, radius);
    if (!(known.share > 0.0)) return {};
    const BallIntegrals ball = integrate(patch, centre, radius, known.reach);
    if (!(ball.volume > 0.0)) return {};
    const double whole = known.share * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    return {true, known.share * ball.first / denominator_of(law, ball, radius, whole), ball.first / ball.volume,
            ball.volume / whole};
}

glm::dvec3 find_middle(const RelevancePatch& patch, const glm::dvec3& centre, double radius, ProxyLaw law,
                       const Proxy& proxy) noexcept
{
    if (!proxy.in_contact) return glm::dvec3(0.0);
    const bool is_exact = law != ProxyLaw::thesis;
    const glm::dvec3 mean = is_exact ? proxy.mean : find_proxy(patch, centre, radius, ProxyLaw::mean).mean;
    return mean + find_proxy(patch, centre + mean, radius, ProxyLaw::mean).mean;
}

}  // namespace shvr
