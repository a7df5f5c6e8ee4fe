#include "engine/study/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "engine/volume/split_mix.h"

namespace shvr {

namespace {

constexpr double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

/// a(n) of interval_of_mean for n = 2 ... 40, computed from Student's and the normal distribution. It is a table
/// because the standard library has no such function, and a table has the same bits on every machine.
constexpr double TAILS[] = {0.0,      6.834e-8, 0.000119, 0.000954, 0.002432, 0.004109, 0.005738, 0.007225,
                            0.008551, 0.009722, 0.010757, 0.011671, 0.012483, 0.013207, 0.013856, 0.014439,
                            0.014966, 0.015445, 0.015881, 0.016280, 0.016646, 0.016983, 0.017294, 0.017582,
                            0.017850, 0.018099, 0.018332, 0.018550, 0.018754, 0.018946, 0.019126, 0.019296,
                            0.019456, 0.019608, 0.019752, 0.019888, 0.020017, 0.020140, 0.020258};
constexpr size_t TABLED = std::size(TAILS) + 1;  ///< the largest n in the table

double tail_of(size_t count)
{
    if (count <= TABLED) return TAILS[count - 2];
    // Beyond the table, 0.025 - a(n) is approximated as proportional to 1 / n, with an error below 0.00004.
    return 0.025 - (0.025 - TAILS[std::size(TAILS) - 1]) * double(TABLED) / double(count);
}

double mean_of(std::span<const double> values)
{
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / double(values.size());
}

double sd_of(std::span<const double> values, double mean)
{
    if (values.size() < 2) return 0.0;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / double(values.size() - 1));
}

int better_sign_of(Outcome outcome)
{
    return outcome_columns()[size_t(outcome)].better;
}

}  // namespace

Interval interval_of_mean(std::span<const double> values, uint64_t seed)
{
    if (values.empty()) return {NOT_KNOWN, NOT_KNOWN};
    if (values.size() == 1) return {values[0], values[0]};
    SplitMix64 random(seed);
    std::vector<double> means(RESAMPLES);
    for (double& mean : means) {
        double sum = 0.0;
        for (size_t i = 0; i < values.size(); ++i) sum += values[random.below(uint32_t(values.size()))];
        mean = sum / double(values.size());
    }
    const auto left_out = ptrdiff_t(tail_of(values.size()) * RESAMPLES);
    const auto low = means.begin() + left_out, high = means.end() - 1 - left_out;
    std::nth_element(means.begin(), low, means.end());
    const double lowest = *low;  // the next call may move it
    std::nth_element(low, high, means.end());
    return {lowest, *high};
}

double quantile_of(std::span<const double> sorted, double share)
{
    if (sorted.empty()) return NOT_KNOWN;
    const double place = share * double(sorted.size() - 1);
    const auto below = size_t(place);
    if (below + 1 >= sorted.size()) return sorted.back();
    return sorted[below] + (place - double(below)) * (sorted[below + 1] - sorted[below]);
}

Summary summary_of(std::span<const double> all)
{
    std::vector<double> values;
    for (const double value : all)
        if (!std::isnan(value)) values.push_back(value);
    Summary summary{.count = values.size(), .interval = interval_of_mean(values)};
    summary.mean = values.empty() ? NOT_KNOWN : mean_of(values);
    summary.sd = values.empty() ? NOT_KNOWN : sd_of(values, summary.mean);
    std::ranges::sort(values);
    summary.least = quantile_of(values, 0.0);
    summary.lower_quartile = quantile_of(values, 0.25);
    summary.median = quantile_of(values, 0.5);
    summary.upper_quartile = quantile_of(values, 0.75);
    summary.most = quantile_of(values, 1.0);
    return summary;
}

std::vector<double> values_of(std::span<const StudyRow> rows, const StudyCondition& condition, Outcome outcome)
{
    std::vector<double> values;
    for (const StudyRow& row : rows)
        if (row.condition == condition && !std::isnan(row[outcome])) values.push_back(row[outcome]);
    return values;
}

bool PairedDifference::is_better(int better_sign) const
{
    if (difference.count < MIN_PAIRS) return false;
    return better_sign > 0 ? difference.interval.low > 0.0 : better_sign < 0 && difference.interval.high < 0.0;
}

PairedDifference paired_difference(std::span<const StudyRow> rows, const StudyCondition& condition,
                                   const StudyCondition& base, Outcome outcome)
{
    std::map<std::pair<uint32_t, uint32_t>, double> of_base;
    for (const StudyRow& row : rows)
        if (row.condition == base && !std::isnan(row[outcome])) of_base[{row.annotator, row.seed}] = row[outcome];
    const int sign = better_sign_of(outcome);
    PairedDifference paired;
    std::vector<double> befores, afters, differences;
    for (const StudyRow& row : rows) {
        const auto before = of_base.find({row.annotator, row.seed});
        if (row.condition != condition || std::isnan(row[outcome]) || before == of_base.end()) continue;
        const double difference = row[outcome] - before->second;
        befores.push_back(before->second);
        afters.push_back(row[outcome]);
        differences.push_back(difference);
        ++(difference * sign > 0.0 ? paired.better : difference * sign < 0.0 ? paired.worse : paired.equal);
    }
    paired.before = summary_of(befores);
    paired.after = summary_of(afters);
    paired.difference = summary_of(differences);
    return paired;
}

std::vector<StudyCondition> conditions_of(std::span<const StudyRow> rows)
{
    std::vector<StudyCondition> conditions;
    for (const StudyRow& row : rows)
        if (std::ranges::find(conditions, row.condition) == conditions.end()) conditions.push_back(row.condition);
    return conditions;
}

}  // namespace shvr
