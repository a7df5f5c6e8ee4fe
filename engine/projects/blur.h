#pragma once
// One-dimensional pass of a separable filter with symmetric weights, for import_prepare.cpp. Any thread may call these.
//
// Sums start at the middle weight and add the two neighbours at equal distance first. So a mirrored volume gives the
// mirrored result, bit for bit.

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace shvr {

/// Rows are filtered in blocks of this many elements, which fit into the processor's registers. Lengths of buffers are
/// multiples of it.
inline constexpr size_t BLUR_BLOCK = 16;

inline constexpr size_t padded_length(size_t length)
{
    return (length + BLUR_BLOCK - 1) / BLUR_BLOCK * BLUR_BLOCK;
}

/// out[i] = weights[0] * middle[i] + sum over k of weights[k] * (before[k - 1][i] + after[k - 1][i]) for i in 0 ...
/// length - 1. `length` is a multiple of BLUR_BLOCK; `before` and `after` hold weights.size() - 1 rows.
template <class Number>
void filter_rows(std::span<const Number> weights, const Number* middle, const Number* const* before,
                 const Number* const* after, Number* out, size_t length)
{
    constexpr size_t LANES = 16 / sizeof(Number);
    constexpr size_t VECTORS = BLUR_BLOCK / LANES;
    // Every x86-64 and ARM64 processor has 16-byte registers (GCC's and Clang's vector extension).
    using Vector [[gnu::vector_size(16)]] = Number;
    const auto load = [](const Number* from) {
        Vector vector;
        std::memcpy(&vector, from, sizeof(vector));
        return vector;
    };
    for (size_t i = 0; i < length; i += BLUR_BLOCK) {
        Vector sum[VECTORS];
#pragma GCC unroll 8
        for (size_t v = 0; v < VECTORS; ++v) sum[v] = load(middle + i + v * LANES) * weights[0];
        for (size_t k = 1; k < weights.size(); ++k) {
            const Number weight = weights[k];
            const Number* const a = before[k - 1] + i;
            const Number* const b = after[k - 1] + i;
#pragma GCC unroll 8
            for (size_t v = 0; v < VECTORS; ++v) sum[v] += (load(a + v * LANES) + load(b + v * LANES)) * weight;
        }
#pragma GCC unroll 8
        for (size_t v = 0; v < VECTORS; ++v) std::memcpy(out + i + v * LANES, &sum[v], sizeof(Vector));
    }
}

/// Filters along one row. `row` points to its first number. In the buffer, weights.size() - 1 numbers precede and
/// follow the row, and padded_length(length) numbers beyond `row` are readable.
template <class Number>
void filter_row(std::span<const Number> weights, const Number* row, Number* out, size_t length)
{
    std::vector<const Number*> before, after;
    for (size_t k = 1; k < weights.size(); ++k) {
        before.push_back(row - k);
        after.push_back(row + k);
    }
    filter_rows(weights, row, before.data(), after.data(), out, padded_length(length));
}

}  // namespace shvr
