#pragma once
// Finds the few values of a volume that are so far from all others that a range including them would show nothing else.

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// Collects the largest and the smallest values, and finds the outliers among them: few values beyond a gap that is
/// wide compared with the range of all others. outliers.cpp has the limits. One thread.
class OutlierFinder {
public:
    /// `voxels`: upper bound of the number of values that will be added.
    explicit OutlierFinder(int64_t voxels);

    /// Adds a finite value that occurs `times` times.
    void add(double value, int64_t times = 1)
    {
        count_ += times;
        if (value >= lowest_kept_of_largest_) add_large(value, times);
        if (value <= highest_kept_of_smallest_) add_small(value, times);
    }

    struct Bulk {
        ValueRange range;      ///< the exact range of all values except the outliers
        int64_t outliers = 0;  ///< at least 1
    };
    /// Null if there are no outliers.
    std::optional<Bulk> bulk();

private:
    void add_large(double value, int64_t times);
    void add_small(double value, int64_t times);

    size_t kept_;  ///< number of values kept at each end
    int64_t count_ = 0;
    // At most three times as many as are kept: the surplus is dropped at twice as many.
    std::vector<double> largest_, smallest_;
    double lowest_kept_of_largest_, highest_kept_of_smallest_;
};

}  // namespace shvr
