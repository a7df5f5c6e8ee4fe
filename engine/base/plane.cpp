#include "engine/base/plane.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/error.h"

namespace shvr {
namespace {

Plane filtered_across(const Plane& plane, std::span<const double> weights, FilterProgress& progress)
{
    const size_t width = size_t(plane.width), radius = weights.size() / 2;
    Plane result(plane.width, plane.height);
    std::vector<double> padded(width + 2 * radius);
    for (size_t start = 0; start < plane.values.size(); start += width) {
        progress.row(2 * plane.height);
        const double* const row = plane.values.data() + start;
        double* const sums = result.values.data() + start;
        std::fill_n(padded.begin(), radius, row[0]);
        std::copy_n(row, width, padded.begin() + std::ptrdiff_t(radius));
        std::fill_n(padded.end() - std::ptrdiff_t(radius), radius, row[width - 1]);
        for (size_t tap = 0; tap < weights.size(); ++tap) {
            const double weight = weights[tap];
            const double* const shifted = padded.data() + tap;
            for (size_t x = 0; x < width; ++x) sums[x] += weight * shifted[x];
        }
    }
    return result;
}

Plane filtered_down(const Plane& plane, std::span<const double> weights, FilterProgress& progress)
{
    const size_t width = size_t(plane.width);
    const int radius = int(weights.size() / 2);
    Plane result(plane.width, plane.height);
    for (int y = 0; y < plane.height; ++y) {
        progress.row(2 * plane.height);
        double* const sums = result.values.data() + size_t(y) * width;
        for (size_t tap = 0; tap < weights.size(); ++tap) {
            const double weight = weights[tap];
            const int source = std::clamp(y + int(tap) - radius, 0, plane.height - 1);
            const double* const row = plane.values.data() + size_t(source) * width;
            for (size_t x = 0; x < width; ++x) sums[x] += weight * row[x];
        }
    }
    return result;
}

}  // namespace

Plane filtered(const Plane& plane, std::span<const double> across, std::span<const double> down,
               FilterProgress& progress)
{
    SHVR_CHECK(across.size() % 2 == 1 && down.size() % 2 == 1, across.size(), ", ", down.size());
    return filtered_down(filtered_across(plane, across, progress), down, progress);
}

std::vector<double> gaussian_weights(double sigma, int radius)
{
    std::vector<double> weights;
    for (int x = -radius; x <= radius; ++x) weights.push_back(std::exp(-x * x / (2.0 * sigma * sigma)));
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights) weight /= sum;
    return weights;
}

}  // namespace shvr
