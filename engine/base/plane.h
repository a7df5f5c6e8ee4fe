#pragma once
// One channel of a picture as doubles, and separable filters over it, for the metrics. Plain values; any thread may use
// its own.

#include <cstddef>
#include <span>
#include <vector>

namespace shvr {

struct Plane {
    int width = 0, height = 0;
    std::vector<double> values;  ///< width * height, rows from the top

    Plane(int plane_width, int plane_height)
        : width(plane_width), height(plane_height), values(size_t(plane_width) * size_t(plane_height))
    {}
};

/// Correlation with `across` along rows and `down` along columns; both have odd lengths, and their middle is the pixel
/// itself. The picture's border is repeated outwards.
Plane filtered(const Plane& plane, std::span<const double> across, std::span<const double> down);

/// exp(-x^2 / (2 sigma^2)) for x = -radius..radius, normalised to a sum of 1.
std::vector<double> gaussian_weights(double sigma, int radius);

}  // namespace shvr
