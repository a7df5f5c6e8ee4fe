#pragma once
// Finds the few values of a volume that are so far from all others that a range including them would show nothing else.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// Collects the largest and the smallest values, and finds the outliers among them: few values beyond a gap that is
/// wide compared with the range of all others, or with the spacing of the values next to it. outliers.cpp has the
/// limits. One thread.
class OutlierFinder {
public:
    /// `voxels`: upper bound of the number of values that will be added. `integers`: few different ones may be labels.
    explicit OutlierFinder(int64_t voxels, bool integers = false);

    /// Adds a finite value that occurs `times` times.
    void add(double value, int64_t times = 1)
    {
        count_ += times;
        if (value >= lowest_kept_of_largest_) add_large(value, times);
        if (value <= highest_kept_of_smallest_) add_small(value, times);
        largest_distinct_.add(value);
        smallest_distinct_.add(-value);
    }

    struct Bulk {
        ValueRange range;      ///< the exact range of all values except the outliers
        int64_t outliers = 0;  ///< at least 1
    };
    /// Null if there are no outliers.
    std::optional<Bulk> bulk();

private:
    static constexpr size_t DISTINCT = 12;
    /// The largest values, each once.
    class Distinct {
    public:
        void add(double value)
        {
            if (value > values_.back()) insert(value);
        }
        /// Descending; minus infinity where there were fewer.
        std::span<const double> values() const { return values_; }
        /// Whether a value is in both, or there are fewer than both can hold. `smallest` has negative values.
        bool overlap(const Distinct& smallest) const { return !(values_.back() > -smallest.values_.back()); }

    private:
        void insert(double value);
        std::array<double, DISTINCT> values_ = [] {
            std::array<double, DISTINCT> none;
            none.fill(-std::numeric_limits<double>::infinity());
            return none;
        }();
    };
    void add_large(double value, int64_t times);
    void add_small(double value, int64_t times);

    bool integers_;
    size_t kept_;  ///< number of values kept at each end
    int64_t count_ = 0;
    // At most three times as many as are kept: the surplus is dropped at twice as many.
    std::vector<double> largest_, smallest_;
    double lowest_kept_of_largest_, highest_kept_of_smallest_;
    Distinct largest_distinct_, smallest_distinct_;  ///< the latter of negative values
};

}  // namespace shvr
