#pragma once
// Textures of tissues and soil: random functions of a position. They use only sums, products, divisions and square
// roots, which give equal bits everywhere. Any thread may call them.

#include <algorithm>
#include <cmath>

#include "engine/volume/procedural/procedural_hash.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Returns value noise in [0, 1): random values at integer coordinates, interpolated smoothly between these.
inline double value_noise(uint32_t seed, const glm::dvec3& place)
{
    const glm::dvec3 cell = glm::floor(place);
    glm::dvec3 t = place - cell;
    t = t * t * (3.0 - 2.0 * t);
    const auto at = [&](int dx, int dy, int dz) {
        return unit_of(hash_of(seed, uint32_t(int64_t(cell.x) + dx), uint32_t(int64_t(cell.y) + dy),
                               uint32_t(int64_t(cell.z) + dz)));
    };
    const auto mix = [](double a, double b, double share) { return a + (b - a) * share; };
    return mix(mix(mix(at(0, 0, 0), at(1, 0, 0), t.x), mix(at(0, 1, 0), at(1, 1, 0), t.x), t.y),
               mix(mix(at(0, 0, 1), at(1, 0, 1), t.x), mix(at(0, 1, 1), at(1, 1, 1), t.x), t.y), t.z);
}

/// Returns the distance from the nearest cell wall, in a cross-section of elongated cells that are about 1 wide.
inline double distance_from_cell_wall(uint32_t seed, const glm::dvec2& place)
{
    const glm::dvec2 cell = glm::floor(place);
    double nearest = 9.0, second = 9.0;  // squared distances from the cells' middles
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const uint32_t hash = hash_of(seed, uint32_t(int64_t(cell.x) + dx), uint32_t(int64_t(cell.y) + dy), 0x5eed);
            const glm::dvec2 middle =
                cell + glm::dvec2(dx, dy) + 0.5 + 0.35 * (2.0 * glm::dvec2(unit_of(hash), unit_of(mixed(hash))) - 1.0);
            const glm::dvec2 d = place - middle;
            const double squared = d.x * d.x + d.y * d.y;
            second = std::min(second, std::max(squared, nearest));
            nearest = std::min(nearest, squared);
        }
    return 0.5 * (std::sqrt(second) - std::sqrt(nearest));
}

}  // namespace shvr
