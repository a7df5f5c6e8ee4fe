#pragma once
// Which few values of a volume lie so far from all others that a range including them would show nothing else.

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// Collects the largest and the smallest values, and finds the outliers among them: values beyond a gap that is wide
/// compared with the range of all others, and few. outliers.cpp has the limits. One thread.
class OutlierFinder {
public:
    /// `voxels`: no more values than that will be added.
    explicit OutlierFinder(int64_t voxels);

    /// A finite value that occurs so many times.
    void add(double value, int64_t times = 1)
    {
        count_ += times;
        if (value >= lowest_kept_of_largest_) add_large(value, times);
        if (value <= highest_kept_of_smallest_) add_small(value, times);
    }

    struct Bulk {
        ValueRange range;      ///< exactly that of all values but the outliers
        int64_t outliers = 0;  ///< at least 1
    };
    /// Nothing if there are no outliers.
    std::optional<Bulk> bulk();

private:
    void add_large(double value, int64_t times);
    void add_small(double value, int64_t times);

    size_t kept_;  ///< values, at each end
    int64_t count_ = 0;
    // Three times as many as are kept, at most: the surplus is dropped at twice as many.
    std::vector<double> largest_, smallest_;
    double lowest_kept_of_largest_, highest_kept_of_smallest_;
};

}  // namespace shvr
