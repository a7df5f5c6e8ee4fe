#pragma once
// A chunk of a volume during import, and the coarser levels computed from it. For import_pyramid.cpp.

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "engine/projects/levels/import_pyramid.h"
#include "engine/volume/halving.h"
#include "engine/volume/source.h"

namespace shvr {

/// The voxels of one level of a chunk and, for each voxel, the range of the voxels of level 0 below. Rows always have
/// IMPORT_CHUNK elements, so that loops have a length known at compile time. A slice has `side` rows.
template <class T>
struct ImportCube {
    explicit ImportCube(int64_t rows) : side(rows), values(size_t(rows * rows * IMPORT_CHUNK)) {}

    size_t row(int64_t y, int64_t z) const { return size_t((y + side * z) * IMPORT_CHUNK); }
    const T* lowest() const { return has_ranges ? lower.data() : values.data(); }
    const T* highest() const { return has_ranges ? upper.data() : values.data(); }

    int64_t side;
    Size3 extent{0};
    bool has_ranges = false;  ///< if false, each voxel's range is its value alone
    std::vector<T> values, lower, upper;
};

/// Makes ranges for level 0 only if some voxels are not finite. A non-finite voxel gets an empty range.
template <class T>
void find_own_ranges(ImportCube<T>& cube)
{
    if constexpr (std::is_floating_point_v<T>) {
        if (std::ranges::all_of(cube.values, [](T value) { return std::isfinite(value); })) return;
        cube.lower = cube.values;
        cube.upper = cube.values;
        for (size_t i = 0; i < cube.values.size(); ++i) {
            if (std::isfinite(cube.values[i])) continue;
            cube.lower[i] = std::numeric_limits<T>::max();
            cube.upper[i] = std::numeric_limits<T>::lowest();
        }
        cube.has_ranges = true;
    }
}

/// `rows` point into the values of `fine`.
template <class T>
void halve_ranges(const ImportCube<T>& fine, const HalvingRows<T>& rows, T* lower, T* upper)
{
    constexpr int64_t SIDE = IMPORT_CHUNK;
    alignas(64) T least[SIDE];
    alignas(64) T most[SIDE];
    for (int row = 0; row < rows.count; ++row) {
        const std::ptrdiff_t first = rows.first[size_t(row)] - fine.values.data();
        const T* const low = fine.lowest() + first;
        const T* const high = fine.highest() + first;
        if (row == 0) {
            std::copy_n(low, SIDE, least);
            std::copy_n(high, SIDE, most);
            continue;
        }
        for (int64_t x = 0; x < SIDE; ++x) least[x] = low[x] < least[x] ? low[x] : least[x];
        for (int64_t x = 0; x < SIDE; ++x) most[x] = high[x] > most[x] ? high[x] : most[x];
    }
    for (int64_t x = 0; x < (fine.extent.x + 1) / 2; ++x) {
        const int64_t second = std::min(2 * x + 1, fine.extent.x - 1);
        lower[x] = std::min(least[2 * x], least[second]);
        upper[x] = std::max(most[2 * x], most[second]);
    }
}

enum class CubeRanges { none, halved };

/// Computes the next coarser level, with its ranges if requested.
template <class T>
void halve_cube(const ImportCube<T>& fine, ImportCube<T>& coarse, Halving how, CubeRanges ranges = CubeRanges::halved)
{
    coarse.extent = size_of_level(fine.extent, 1);
    coarse.has_ranges = ranges == CubeRanges::halved;
    if (coarse.has_ranges) {
        coarse.lower.resize(coarse.values.size());
        coarse.upper.resize(coarse.values.size());
    }
    for (int64_t z = 0; z < coarse.extent.z; ++z) {
        for (int64_t y = 0; y < coarse.extent.y; ++y) {
            HalvingRows<T> rows;
            for (int64_t dz = 2 * z; dz < std::min(2 * z + 2, fine.extent.z); ++dz) {
                for (int64_t dy = 2 * y; dy < std::min(2 * y + 2, fine.extent.y); ++dy) {
                    rows.first[size_t(rows.count++)] = fine.values.data() + fine.row(dy, dz);
                }
            }
            const size_t to = coarse.row(y, z);
            if (coarse.has_ranges) halve_ranges(fine, rows, coarse.lower.data() + to, coarse.upper.data() + to);
            halve_rows(rows, fine.extent.x, coarse.values.data() + to, how);
        }
    }
}

}  // namespace shvr
