#pragma once
// Finds the few values of a volume that lie so far from all others that the full range would hide the other values.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// Collects the largest and the smallest values, and finds two kinds of values among them:
/// - fill values: single values, however frequent, at an end of the range, behind a gap that is wide for all others;
/// - outliers: few values beyond a gap that is wide compared with the range of all others, or with the spacing of the
///   values next to the gap.
/// outliers.cpp defines the limits. One thread.
class OutlierFinder {
public:
    /// `voxels`: upper bound of the number of values to be added. `type`: integers with few distinct values may be
    /// labels. `nodata`: the only fill value, if it is known (VolumeInfo::nodata).
    explicit OutlierFinder(int64_t voxels, VoxelType type = VoxelType::float64, std::optional<double> nodata = {});

    /// Adds `times` voxels with the finite value `value`.
    void add(double value, int64_t times = 1)
    {
        if (value == nodata_) {
            nodata_voxels_ += times;
            return;
        }
        count_ += times;
        largest_.add(value, times);
        smallest_.add(-value, times);
    }

    struct Bulk {
        ValueRange range;      ///< exact range of the values that are neither fill values nor outliers
        int64_t outliers = 0;  ///< those that are no fill values
        std::vector<ValueCount> fill{};
    };
    /// Null if there are neither outliers nor fill values.
    std::optional<Bulk> bulk();

    /// Keeps the largest distinct values, with the count of each.
    class Largest {
    public:
        explicit Largest(size_t kept) : kept_(kept) {}
        void add(double value, int64_t times)
        {
            if (value < least_) return;
            if (value == most_.value)
                most_.voxels += times;
            else if (!others_.empty() && others_.back().value == value)  // neighbours are often equal
                others_.back().voxels += times;
            else
                append(value, times);
        }
        /// Descending; `kept` of them, or all.
        std::vector<ValueCount> sorted() const;

    private:
        void append(double value, int64_t times);
        void shrink();

        size_t kept_;
        double least_ = -std::numeric_limits<double>::infinity();  ///< smaller ones are dropped
        ValueCount most_{-std::numeric_limits<double>::infinity(), 0};
        std::vector<ValueCount> others_;  ///< candidates in any order; reduced once there are twice as many as needed
    };

private:
    bool is_fill_like(double value, bool has_exact_codes, double gap) const;
    class End;
    void exclude_strays(End& upper, End& lower, bool has_exact_codes) const;
    bool exclude_fill(End& upper, End& lower, bool has_exact_codes) const;

    VoxelType type_;
    double nodata_;  ///< infinite if there is none
    bool finds_fill_;
    int64_t count_ = 0, nodata_voxels_ = 0;
    Largest largest_, smallest_;  ///< the latter of negative values
};

}  // namespace shvr
