#pragma once
// Statistics of a study's rows: means, medians, spread, 95 % bootstrap intervals, differences of paired rows. Uses only
// operations that IEEE 754 defines exactly, in a fixed order, and its own random number generator, so that equal rows
// give equal bits on every machine. Any thread.

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
/// (Hesterberg, "What teachers should know about the bootstrap", The American Statistician 69(4), 2015). The plain
/// percentile interval is too narrow for few values: by sqrt((n - 1) / n), and since it uses quantiles of the normal
/// instead of Student's distribution. This method corrects both, stays within the values' range (a Dice score stays
/// below 1) and follows their skew. BCa corrects skew better for many values, but is too narrow for few, and its last
/// bits depend on the machine's normal quantiles. For one value both ends are the value; without values they are NaN.
Interval interval_of_mean(std::span<const double> values, uint64_t seed = 1);

/// NaN values are left out. Without any value, all members except `count` are NaN.
struct Summary {
    size_t count = 0;
    double mean = 0.0, sd = 0.0;  ///< sd: standard deviation of the sample (divisor count - 1); 0 for one value
    double least = 0.0, lower_quartile = 0.0, median = 0.0, upper_quartile = 0.0, most = 0.0;
    Interval interval;  ///< interval_of_mean
};
Summary summary_of(std::span<const double> values);

/// Returns a quantile of sorted values by linear interpolation (type 7 of Hyndman and Fan, 1996). NaN without values.
double quantile_of(std::span<const double> sorted, double share);

/// Returns the values of an outcome under one condition, without NaN, in the order of the rows.
std::vector<double> values_of(std::span<const StudyRow> rows, const StudyCondition& condition, Outcome outcome);

/// Fewer pairs decide nothing: the 95 % interval of 3 values holds the mean in only 75 % of samples, that of 5 in 90 %.
inline constexpr size_t MIN_PAIRS = 5;

/// The difference `condition` - `base` in each pair: the same annotator and seed, with a value under both conditions.
struct PairedDifference {
    Summary before, after;  ///< summaries of `base` and of `condition`, in these pairs only
    Summary difference;
    size_t better = 0, worse = 0, equal = 0;  ///< numbers of pairs, by OutcomeColumn::better; if it is 0, all are equal
    /// Whether there are MIN_PAIRS, and the whole interval of the difference lies on the better side of 0.
    bool is_better(int better_sign) const;
    bool is_worse(int better_sign) const { return is_better(-better_sign); }
};
PairedDifference paired_difference(std::span<const StudyRow> rows, const StudyCondition& condition,
                                   const StudyCondition& base, Outcome outcome);

/// Returns the different conditions of the rows, in the order of their first row.
std::vector<StudyCondition> conditions_of(std::span<const StudyRow> rows);

}  // namespace shvr
