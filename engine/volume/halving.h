#pragma once
// Computes a coarser level from a finer one, for projects and for levels in memory.
//
// A voxel is the mean of the up to 2^3 voxels below it. Only finite voxels inside the volume count; if there are none,
// the mean is NaN. Sums are exact for integers and computed in double for floats, along y and z before x. Integers are
// rounded to nearest, ties to even; floats are rounded once, to their type. Any thread may call these.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace shvr {

enum class Halving {
    mean,   ///< mean of intensities
    label,  ///< the most frequent label, since a mean of labels is meaningless
};

/// A type that holds the sum of eight voxels without overflow.
template <class T>
using HalvingSum =
    std::conditional_t<std::is_floating_point_v<T>, double, std::conditional_t<sizeof(T) == 4, int64_t, int32_t>>;

/// Those 1, 2 or 4 rows of the finer level that are below one row of the coarser level.
template <class T>
struct HalvingRows {
    std::array<const T*, 4> first{};
    int count = 0;
};

namespace halving {

/// Returns the mean of COUNT (1, 2, 4 or 8) voxels from their sum.
template <int COUNT, class T>
T mean_of(HalvingSum<T> sum)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(sum / COUNT);
    } else if constexpr (COUNT == 1) {
        return static_cast<T>(sum);
    } else {
        constexpr int SHIFT = COUNT == 8 ? 3 : COUNT == 4 ? 2 : 1;
        // Rounds to nearest, ties to even: adds divisor / 2 - 1, and 1 more if the quotient is odd.
        const HalvingSum<T> odd = (sum >> SHIFT) & 1;
        return static_cast<T>((sum + (HalvingSum<T>{1} << (SHIFT - 1)) - 1 + odd) >> SHIFT);
    }
}

/// Returns the mean of voxels `begin` to `end` of every row, leaving out non-finite voxels.
template <class T>
T mean_of_finite(const HalvingRows<T>& rows, int64_t begin, int64_t end)
{
    double sum[2] = {};
    int count = 0;
    for (int row = 0; row < rows.count; ++row) {
        for (int64_t x = begin; x < end; ++x) {
            const T voxel = rows.first[size_t(row)][x];
            if (!std::isfinite(voxel)) continue;
            sum[x - begin] += double(voxel);
            ++count;
        }
    }
    return count > 0 ? static_cast<T>((sum[0] + sum[1]) / count) : std::numeric_limits<T>::quiet_NaN();
}

/// The inner loops have this length, which is known at compile time, so that the compiler can vectorise them.
inline constexpr int64_t BLOCK = 64;

template <int ROWS, class T, class Length>
void halve_block(const HalvingRows<T>& rows, int64_t at, Length length, T* halved)
{
    using Sum = HalvingSum<T>;
    alignas(64) Sum sum[BLOCK];
    for (int64_t x = 0; x < length; ++x) sum[x] = static_cast<Sum>(rows.first[0][at + x]);
    for (size_t row = 1; row < size_t{ROWS}; ++row) {
        for (int64_t x = 0; x < length; ++x) sum[x] += static_cast<Sum>(rows.first[row][at + x]);
    }
    for (int64_t x = 0; x < length / 2; ++x) halved[x] = mean_of<2 * ROWS, T>(sum[2 * x] + sum[2 * x + 1]);
    if (length % 2 != 0) {
        const int64_t last = at + length - 1;
        Sum alone = static_cast<Sum>(rows.first[0][last]);
        for (size_t row = 1; row < size_t{ROWS}; ++row) alone += static_cast<Sum>(rows.first[row][last]);
        halved[length / 2] = mean_of<ROWS, T>(alone);
    }
    if constexpr (std::is_floating_point_v<T>) {
        // A mean that is not finite includes a non-finite voxel: computes the mean again from the finite voxels alone.
        for (int64_t x = 0; x < length; x += 2) {
            if (std::isfinite(halved[x / 2])) continue;
            halved[x / 2] = mean_of_finite(rows, at + x, at + std::min<int64_t>(x + 2, length));
        }
    }
}

template <int ROWS, class T>
void halve(const HalvingRows<T>& rows, int64_t length, T* halved)
{
    int64_t at = 0;
    for (; at + BLOCK <= length; at += BLOCK) {
        halve_block<ROWS>(rows, at, std::integral_constant<int64_t, BLOCK>{}, halved + at / 2);
    }
    if (at < length) halve_block<ROWS>(rows, at, length - at, halved + at / 2);
}

}  // namespace halving

/// Returns the most frequent label. Of equally frequent labels, returns the smallest that is not 0 (background).
template <class T>
void halve_labels(const HalvingRows<T>& rows, int64_t length, T* halved)
{
    for (int64_t x = 0; x < length; x += 2) {
        std::array<T, 8> voxels{};
        size_t count = 0;
        for (size_t row = 0; row < size_t(rows.count); ++row)
            for (int64_t i = x; i < std::min(x + 2, length); ++i) voxels[count++] = rows.first[row][i];
        T best{};
        size_t most = 0;
        for (size_t i = 0; i < count; ++i) {
            size_t equal = 0;
            for (size_t k = 0; k < count; ++k) equal += voxels[k] == voxels[i];
            const bool wins_tie = equal == most && voxels[i] != T{} && (best == T{} || voxels[i] < best);
            if (equal < most || (equal == most && !wins_tie)) continue;
            most = equal;
            best = voxels[i];
        }
        halved[x / 2] = best;
    }
}

/// Computes (length + 1) / 2 voxels of the coarser level from rows of `length` voxels.
template <class T>
void halve_rows(const HalvingRows<T>& rows, int64_t length, T* halved, Halving how = Halving::mean)
{
    if (how == Halving::label) return halve_labels(rows, length, halved);
    if (rows.count == 4) return halving::halve<4>(rows, length, halved);
    if (rows.count == 2) return halving::halve<2>(rows, length, halved);
    halving::halve<1>(rows, length, halved);
}

}  // namespace shvr
