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
};

}  // namespace

OutlierFinder::OutlierFinder(int64_t voxels)
    : kept_(size_t(FAR.limit(voxels) + NEAR.limit(voxels) + 1)),
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
    for (const Rule& rule : {FAR, NEAR}) {
        const int64_t limit = rule.limit(count_);
        const double upper_end = upper.innermost(limit), lower_end = lower.innermost(limit);
        // If nearly all voxels are equal, the few others are the interesting ones.
        if (!(lower_end < upper_end)) continue;
        upper.exclude(rule, limit, lower_end);
        lower.exclude(rule, limit, upper_end);
    }
    if (upper.outliers + lower.outliers == 0) return std::nullopt;
    return Bulk{{lower.innermost(0), upper.innermost(0)}, upper.outliers + lower.outliers};
}

}  // namespace shvr
