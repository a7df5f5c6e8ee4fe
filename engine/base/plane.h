#pragma once
// One channel of a picture as doubles, and separable filters over it, for the metrics. Planes are plain values; each
// thread may use its own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"

namespace shvr {

struct Plane {
    int width = 0, height = 0;
    std::vector<double> values;  ///< width * height, rows from the top

    Plane(int plane_width, int plane_height)
        : width(plane_width), height(plane_height), values(size_t(plane_width) * size_t(plane_height))
    {}
};

/// Reports the progress of several filters, row by row. If `progress` throws, the filters stop. One thread.
class FilterProgress {
public:
    FilterProgress(Progress progress, double filters) : progress_(std::move(progress)), filters_(filters) {}

    void row(int rows_of_filter)
    {
        done_ += 1.0 / rows_of_filter;
        if (++rows_ % ROWS_TOLD == 0) tell(progress_, done_ / filters_);
    }

private:
    static constexpr int64_t ROWS_TOLD = 64;
    Progress progress_;
    double filters_, done_ = 0.0;
    int64_t rows_ = 0;
};

/// Correlates the plane with the weights `across` along rows and `down` along columns. Both have odd lengths; the
/// middle weight applies to the pixel itself. Outside the picture, the nearest pixel of its border is used.
Plane filtered(const Plane& plane, std::span<const double> across, std::span<const double> down,
               FilterProgress& progress);

/// exp(-x^2 / (2 sigma^2)) for x = -radius..radius, normalised to a sum of 1.
std::vector<double> gaussian_weights(double sigma, int radius);

}  // namespace shvr
