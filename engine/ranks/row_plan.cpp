#include "engine/ranks/row_plan.h"

#include <algorithm>
#include <numeric>

namespace shvr {

namespace {

/// Work of a row without any counted work, as a share of the mean: its pixels are sent and written, too.
constexpr double EMPTY_ROW = 0.02;

/// Work above each row; one more element than there are rows.
std::vector<double> work_above(int64_t rows, const std::vector<double>& work)
{
    const double sum = std::accumulate(work.begin(), work.end(), 0.0);
    const double mean = sum > 0.0 ? sum / double(work.size()) : 1.0;
    std::vector<double> above{0.0};
    above.reserve(size_t(rows) + 1);
    for (int64_t row = 0; row < rows; ++row) {
        const double counted = sum > 0.0 ? work[size_t(row) * work.size() / size_t(rows)] : mean;
        above.push_back(above.back() + counted + EMPTY_ROW * mean);
    }
    return above;
}

}  // namespace

RowPlan::RowPlan(int64_t rows, const std::vector<double>& work, int ranks, int64_t rows_at_once)
    : strips_(size_t(ranks))
{
    const std::vector<double> above = work_above(rows, work);
    const int64_t at_once = std::max<int64_t>(rows_at_once, 1);
    for (int64_t begin = 0; begin < rows; begin += at_once) {
        const int64_t end = std::min(begin + at_once, rows);
        const double first = above[size_t(begin)], sum = above[size_t(end)] - first;
        int64_t lower = begin;
        for (int rank = 0; rank < ranks; ++rank) {
            const double border = first + sum * (rank + 1) / ranks;
            int64_t upper = std::lower_bound(above.begin() + lower, above.begin() + end, border) - above.begin();
            // The nearer of the two rows between which the border lies.
            if (upper > lower && border - above[size_t(upper) - 1] < above[size_t(upper)] - border) --upper;
            if (rank + 1 == ranks) upper = end;
            if (upper > lower) strips_[size_t(rank)].push_back({lower, upper});
            lower = std::max(lower, upper);
        }
    }
}

std::optional<RowStrip> RowPlan::peek(int rank) const
{
    const std::deque<RowStrip>& strips = strips_[size_t(rank)];
    return strips.empty() ? std::nullopt : std::optional(strips.front());
}

std::optional<RowStrip> RowPlan::next(int rank)
{
    const std::optional<RowStrip> strip = peek(rank);
    if (strip) strips_[size_t(rank)].pop_front();
    return strip;
}

}  // namespace shvr
