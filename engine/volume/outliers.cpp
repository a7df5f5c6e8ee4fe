#include "engine/volume/outliers.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace shvr {
namespace {

/// With fewer voxels than that (a cube of three), no values are usual enough to call others outliers.
constexpr int64_t MIN_VOXELS = 27;

/// Outliers at one end are at most a fraction of all voxels, or at most `few`, and lie beyond a gap of `gap` times the
/// range of all others. Rare bright structures in a scan, such as metal or one vessel, have more voxels than that, or
/// blend into the rest through partial-volume voxels, so they leave no gap.
struct Rule {
    double share;
    int64_t few;
    double gap;

    int64_t limit(int64_t voxels) const
    {
        constexpr int64_t MAX_OUTLIERS = 16384;  // bounds the memory
        const int64_t some = std::min(few, std::max<int64_t>(1, voxels / 100));
        return std::clamp(int64_t(share * double(voxels)), some, MAX_OUTLIERS);
    }
};
/// Rule for fill values and broken voxels: with them, all others would share fewer than 66 of the 65536 codes.
constexpr Rule FAR{1e-4, 8, 1000.0};
/// Hot pixels.
constexpr Rule NEAR{1e-5, 1, 4.0};

/// Hot and dead pixels at any distance are as few, but told by the spacing of the values next to them. In the tail of a
/// distribution the gap between the k-th and the next value is about unit / k; one of ten units at the first is chance
/// in one of 20,000 scans. The gap must also exceed what separates the outermost values, or labels, from each other,
/// and be large enough to matter.
constexpr int64_t TAIL = 32;  ///< values that tell the unit
constexpr int64_t MIN_VOXELS_OF_TAIL = 4 * TAIL;
constexpr double MIN_UNITS = 10.0, MIN_STEPS = 2.0, MIN_SHARE = 0.01;
constexpr size_t STEPS = 8;

/// Half of a - b, which is finite for all finite a and b.
double half_distance(double a, double b)
{
    return 0.5 * a - 0.5 * b;
}

/// One end of the sorted values.
struct End {
    const std::vector<double>& values;  ///< from the outermost inwards
    int64_t outliers = 0;               ///< the first of them

    double innermost(int64_t limit) const { return values[size_t(outliers + limit)]; }

    /// Walks outwards, and excludes everything beyond the first gap.
    void exclude(const Rule& rule, int64_t limit, double other_end)
    {
        for (int64_t i = outliers + limit; i-- > outliers;) {
            const double inside = values[size_t(i + 1)], outside = values[size_t(i)];
            const double range = std::abs(half_distance(inside, other_end));
            if (std::abs(half_distance(outside, inside)) <= rule.gap * range) continue;
            outliers = i + 1;
            return;
        }
    }

    /// Excludes what is far out for the spacing of the values inside. `distinct`: the outermost values times `sign`,
    /// each once, descending.
    void exclude_isolated(std::span<const double> distinct, double sign, int64_t limit, double range)
    {
        for (int64_t i = outliers + limit; i-- > outliers;) {
            const double inside = values[size_t(i + 1)];
            const double gap = std::abs(values[size_t(i)] - inside);
            double harmonic = 0.0;
            for (int64_t k = 2; k <= TAIL; ++k) harmonic += 1.0 / double(k);
            const double unit = std::abs(inside - values[size_t(i + TAIL)]) / harmonic;
            if (gap >
                std::max({MIN_SHARE * range, MIN_UNITS * unit, MIN_STEPS * largest_step(distinct, sign * inside)})) {
                outliers = i + 1;
                return;
            }
        }
    }

private:
    /// The largest distance between neighbours of the outermost distinct values from `inside` on.
    static double largest_step(std::span<const double> distinct, double inside)
    {
        double largest = 0.0;
        size_t steps = 0;
        for (size_t k = 0; k + 1 < distinct.size() && steps < STEPS; ++k) {
            if (distinct[k] > inside) continue;
            largest = std::max(largest, distinct[k] - distinct[k + 1]);
            ++steps;
        }
        return largest;
    }
};

}  // namespace

void OutlierFinder::Distinct::insert(double value)
{
    auto place = std::ranges::lower_bound(values_, value, std::greater<>());
    if (*place == value) return;
    std::move_backward(place, values_.end() - 1, values_.end());
    *place = value;
}

OutlierFinder::OutlierFinder(int64_t voxels, bool integers)
    : integers_(integers),
      kept_(size_t(FAR.limit(voxels) + 2 * NEAR.limit(voxels) + TAIL + 1)),
      lowest_kept_of_largest_(-std::numeric_limits<double>::infinity()),
      highest_kept_of_smallest_(std::numeric_limits<double>::infinity())
{}

void OutlierFinder::add_large(double value, int64_t times)
{
    largest_.insert(largest_.end(), std::min(size_t(times), kept_), value);
    if (largest_.size() < 2 * kept_) return;
    std::ranges::nth_element(largest_, largest_.begin() + std::ptrdiff_t(kept_ - 1), std::greater<>());
    largest_.resize(kept_);
    lowest_kept_of_largest_ = largest_.back();
}

void OutlierFinder::add_small(double value, int64_t times)
{
    smallest_.insert(smallest_.end(), std::min(size_t(times), kept_), value);
    if (smallest_.size() < 2 * kept_) return;
    std::ranges::nth_element(smallest_, smallest_.begin() + std::ptrdiff_t(kept_ - 1));
    smallest_.resize(kept_);
    highest_kept_of_smallest_ = smallest_.back();
}

std::optional<OutlierFinder::Bulk> OutlierFinder::bulk()
{
    if (count_ < MIN_VOXELS) return std::nullopt;
    std::ranges::sort(largest_, std::greater<>());
    std::ranges::sort(smallest_);
    End upper{largest_}, lower{smallest_};
    // Few different values are labels, or two materials: each is interesting.
    const bool is_continuous = !largest_distinct_.overlap(smallest_distinct_);
    const bool has_exact_codes = integers_ && half_distance(largest_.front(), smallest_.front()) <= 0.5 * 65535.0;
    for (const Rule& rule : {FAR, NEAR}) {
        if (!is_continuous && (has_exact_codes || rule.gap == NEAR.gap)) continue;
        const int64_t limit = rule.limit(count_);
        const double upper_end = upper.innermost(limit), lower_end = lower.innermost(limit);
        // If nearly all voxels are equal, the few others are the interesting ones.
        if (!(lower_end < upper_end)) continue;
        upper.exclude(rule, limit, lower_end);
        lower.exclude(rule, limit, upper_end);
    }
    if (count_ >= MIN_VOXELS_OF_TAIL && is_continuous) {
        const int64_t limit = NEAR.limit(count_);
        const double range = 2.0 * half_distance(upper.innermost(limit), lower.innermost(limit));
        if (range > 0.0) {
            upper.exclude_isolated(largest_distinct_.values(), 1.0, limit, range);
            lower.exclude_isolated(smallest_distinct_.values(), -1.0, limit, range);
        }
    }
    if (upper.outliers + lower.outliers == 0) return std::nullopt;
    return Bulk{{lower.innermost(0), upper.innermost(0)}, upper.outliers + lower.outliers};
}

}  // namespace shvr
