#pragma once
// Statistics of a study's rows: means, medians, spread, 95 % bootstrap intervals, differences of paired rows. Uses only
// operations that IEEE 754 defines exactly, in a fixed order, and a generator of its own: equal rows give equal bits on
// every machine. Any thread.

#include <cstdint>
#include <span>
#include <vector>

#include "engine/study/rows.h"

namespace shvr {

struct Interval {
    double low = 0.0, high = 0.0;
    bool holds(double value) const { return value >= low && value <= high; }
};

inline constexpr uint32_t RESAMPLES = 10000;  ///< Hesterberg 2015 recommends at least this many

/// The 95 % interval of the mean, by the expanded percentile bootstrap: resampled means are sorted, and the interval
/// lies between their quantiles a(n) and 1 - a(n), with
///
///     a(n) = Phi(-sqrt(n / (n - 1)) t(0.975, n - 1))
///
/// (Hesterberg, "What teachers should know about the bootstrap", The American Statistician 69(4), 2015). The
/// plain percentile interval is too narrow for few values, by sqrt((n - 1) / n) and by the quantile of the normal
/// distribution in place of Student's; this one corrects both, keeps within the values (a Dice score stays below 1),
/// and follows their skew. BCa would correct skew better for many values, but is too narrow for few, and needs normal
/// quantiles of the data, whose last bits depend on the machine. One value, or none: both ends are it, or NaN.
Interval interval_of_mean(std::span<const double> values, uint64_t seed = 1);

/// Values that are NaN are left out. Without values all but `count` are NaN.
struct Summary {
    size_t count = 0;
    double mean = 0.0, sd = 0.0;  ///< sd: of the sample, by count - 1; 0 for one value
    double least = 0.0, lower_quartile = 0.0, median = 0.0, upper_quartile = 0.0, most = 0.0;
    Interval interval;  ///< interval_of_mean
};
Summary summary_of(std::span<const double> values);

/// Quantile of sorted values by linear interpolation (type 7 of Hyndman and Fan, 1996). NaN without values.
double quantile_of(std::span<const double> sorted, double share);

/// The outcomes of one condition, without NaN, in the order of the rows.
std::vector<double> values_of(std::span<const StudyRow> rows, const StudyCondition& condition, Outcome outcome);

/// `condition` minus `base`, for each annotator and seed that has a value under both.
struct PairedDifference {
    Summary before, after;  ///< values of `base` and of `condition`, in these pairs alone
    Summary difference;
    size_t better = 0, worse = 0, equal = 0;  ///< pairs, by OutcomeColumn::better; all equal if that is 0
    /// Whether the interval excludes 0 on the better, or on the worse side.
    bool is_better(int better_sign) const;
    bool is_worse(int better_sign) const { return is_better(-better_sign); }
};
PairedDifference paired_difference(std::span<const StudyRow> rows, const StudyCondition& condition,
                                   const StudyCondition& base, Outcome outcome);

/// The conditions of the rows, each once, in the order of their first row.
std::vector<StudyCondition> conditions_of(std::span<const StudyRow> rows);

}  // namespace shvr
