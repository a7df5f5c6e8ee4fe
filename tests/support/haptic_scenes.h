#pragma once
// Scenes for the haptics tests: relevance built from a predicate on points, and a slow exact result for a ball in it.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

#include "haptics/proxy.h"

namespace shvr {

/// The voxels, `size` of them from `origin` on, whose centres satisfy `is_relevant`.
template <class Claim>
void fill_patch(RelevancePatch& patch, const glm::ivec3& origin, const glm::ivec3& size, const glm::dvec3& spacing,
                const Claim& is_relevant)
{
    patch.sequence += 1;
    patch.origin = origin;
    patch.size = size;
    patch.spacing = spacing;
    patch.words_per_row = (size.x + 31) / 32;
    std::fill_n(patch.words.begin(), patch.word_count(), 0u);
    for (int z = 0; z < size.z; ++z) {
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                const glm::dvec3 centre = (glm::dvec3(origin + glm::ivec3(x, y, z)) + 0.5) * spacing;
                const auto word = size_t(x / 32 + patch.words_per_row * (y + size.y * z));
                if (is_relevant(centre)) patch.words[word] |= 1u << (x % 32);
            }
        }
    }
}

inline bool is_set(const RelevancePatch& patch, int x, int y, int z)
{
    return patch.row_word(x / 32, y, z) >> (x % 32) & 1u;
}

/// An infinite round rod.
struct Rod {
    glm::dvec3 point{0.0}, direction{1.0, 0.0, 0.0};
    double radius = 1.0;
    bool holds(const glm::dvec3& p) const
    {
        const glm::dvec3 away = p - point - direction * glm::dot(p - point, direction);
        return glm::dot(away, away) <= radius * radius;
    }
};

/// A winding vessel's middle line: y = middle + y_reach sin(x / y_length), z = middle + z_reach cos(x / z_length).
struct WindingLine {
    double middle, y_reach, y_length, z_reach, z_length;
    glm::dvec3 at(double x) const
    {
        return {x, middle + y_reach * std::sin(x / y_length), middle + z_reach * std::cos(x / z_length)};
    }
    /// From the line's nearest point to `p`, by Newton's method from the same x.
    glm::dvec3 towards(const glm::dvec3& p) const
    {
        double x = p.x;
        for (int i = 0; i < 4; ++i) {
            const glm::dvec3 slope(1.0, y_reach / y_length * std::cos(x / y_length),
                                   -z_reach / z_length * std::sin(x / z_length));
            x += glm::dot(p - at(x), slope) / glm::dot(slope, slope);
        }
        return p - at(x);
    }
};

/// Treats relevant voxels as boxes, each integrated along `lines` x `lines` lines parallel to x with exact ends.
inline BallIntegrals integrate_slowly(const RelevancePatch& patch, const glm::dvec3& centre, double radius, int lines)
{
    BallIntegrals ball;
    const glm::dvec3 s = patch.spacing;
    const double weight = s.y * s.z / (lines * lines);
    for (int z = 0; z < patch.size.z; ++z) {
        for (int y = 0; y < patch.size.y; ++y) {
            for (int x = 0; x < patch.size.x; ++x) {
                if (!is_set(patch, x, y, z)) continue;
                const glm::dvec3 lower = glm::dvec3(patch.origin + glm::ivec3(x, y, z)) * s - centre;
                if (glm::length(lower + 0.5 * s) > radius + glm::length(s)) continue;
                for (int j = 0; j < lines * lines; ++j) {
                    const double dy = lower.y + s.y * (j % lines + 0.5) / lines;
                    const double dz = lower.z + s.z * (j / lines + 0.5) / lines;
                    const double rest = radius * radius - dy * dy - dz * dz;
                    if (rest <= 0.0) continue;
                    const double a = std::max(lower.x, -std::sqrt(rest)), b = std::min(lower.x + s.x, std::sqrt(rest));
                    if (a >= b) continue;
                    ball.volume += weight * (b - a);
                    ball.first += weight * glm::dvec3((b * b - a * a) / 2.0, dy * (b - a), dz * (b - a));
                    ball.second += weight * ((b * b * b - a * a * a) / 3.0 + (dy * dy + dz * dz) * (b - a));
                }
            }
        }
    }
    return ball;
}

}  // namespace shvr
