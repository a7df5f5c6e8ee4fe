#include "engine/volume/outliers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace shvr {
namespace {

/// Smaller volumes (less than 3^3 voxels) have no outliers: too few voxels are left to compare with.
constexpr int64_t MIN_VOXELS = 27;

/// Values at one end are outliers if they lie beyond a gap of `gap` times the range of all other values, and if they
/// are at most a fraction `share` of all voxels, or `few` voxels. Rare bright structures in a scan, such as metal or
/// one vessel, have more voxels, or have no gap because of partial-volume voxels at their surface.
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
/// Rule for undetected fill values and broken voxels, which would leave fewer than 66 of 65536 codes for other values.
constexpr Rule FAR{1e-4, 8, 1000.0};
/// Hot pixels.
constexpr Rule NEAR{1e-5, 1, 4.0};

/// Hot and dead pixels are few, and recognised by the spacing of the values next to them. In the tail of a
/// distribution, the gap between the k-th and the next value is about unit / k; a first gap of ten units occurs by
/// chance in one of 20,000 scans. The gap must also be a minimum fraction of the range, and exceed the distances
/// between the outermost values, which may be labels.
constexpr int64_t TAIL = 32;  ///< values that tell the unit
constexpr int64_t MIN_VOXELS_OF_TAIL = 4 * TAIL;
constexpr double MIN_UNITS = 10.0, MIN_STEPS = 2.0, MIN_SHARE = 0.01;
constexpr int STEPS = 8;

/// If there are fewer distinct values than this, they are labels or a few materials, and none of them is an outlier.
constexpr size_t MIN_VALUES_AT_END = 12;

/// Fill values lie behind a gap of this many times the range of all other values. A smaller gap is sufficient for the
/// smallest and the largest value of a type, which are rarely measured. 0 is air or background, not a fill value: scans
/// are masked with 0, and a synthetic scan may have objects of nearly one intensity in it. If every value has its own
/// code, only negative values and the type's extremes qualify: positive values may be labels, and excluding them would
/// only improve automatic settings. Saturated voxels have no gap, because of partial-volume voxels.
constexpr double MIN_GAP_OF_FILL = 10.0, MIN_GAP_OF_EXTREME = 2.0;
constexpr size_t MAX_FILL_VALUES = 3;  ///< at one end
constexpr int64_t MIN_VOXELS_OF_FILL = 2;
constexpr double FLOAT_EXTREME = 1e30;  ///< floats this large are markers

/// Returns (a - b) / 2, which is finite for all finite a and b, even if a - b overflows to infinity.
double half_distance(double a, double b)
{
    return 0.5 * a - 0.5 * b;
}

/// Returns whether the value is the smallest or largest of its type; false for types whose full range scanners use.
bool is_extreme(VoxelType type, double value)
{
    switch (type) {
        case VoxelType::uint8:
        case VoxelType::int8: return false;
        case VoxelType::uint16: return value == 65535.0;
        case VoxelType::int16: return value == -32768.0 || value == 32767.0;
        case VoxelType::uint32: return value == 4294967295.0;
        case VoxelType::int32: return value == -2147483648.0 || value == 2147483647.0;
        case VoxelType::float32:
        case VoxelType::float64: return std::abs(value) >= FLOAT_EXTREME;
    }
    return false;
}

}  // namespace

/// One end of the sorted values. Values are negated at the lower end, so that both ends are in descending order.
class OutlierFinder::End {
public:
    explicit End(const Largest& values) : values_(values.sorted()) {}

    /// Returns the value of voxel number `place`, counted inwards from the outermost voxel that is still included.
    double at(int64_t place) const
    {
        size_t i = first_;
        for (; i + 1 < values_.size() && place >= values_[i].voxels; ++i) place -= values_[i].voxels;
        return values_[i].value;
    }
    /// The outermost value that is not excluded.
    double outermost() const { return values_[first_].value; }
    double at_start() const { return values_.front().value; }
    int64_t outliers() const { return outliers_; }
    int64_t fill_voxels() const
    {
        int64_t voxels = 0;
        for (const ValueCount& each : fill_) voxels += each.voxels;
        return voxels;
    }
    const std::vector<ValueCount>& fill() const { return fill_; }

    /// Returns the k-th distinct value, counted inwards; minus infinity if there are fewer values.
    double different(size_t k) const
    {
        return first_ + k < values_.size() ? values_[first_ + k].value : -std::numeric_limits<double>::infinity();
    }

    /// Tests gaps from the inside outwards, and excludes all values beyond the first gap that satisfies the rule.
    void exclude(const Rule& rule, int64_t limit, double other_end)
    {
        exclude_beyond(limit, [&](size_t last, int64_t) {
            const double inside = values_[last + 1].value, outside = values_[last].value;
            return half_distance(outside, inside) > rule.gap * half_distance(inside, other_end);
        });
    }

    /// Excludes values whose distance from the others is large, compared with the spacing of the others.
    void exclude_isolated(int64_t limit, double range)
    {
        exclude_beyond(limit, [&](size_t last, int64_t voxels) {
            const double inside = values_[last + 1].value, gap = values_[last].value - inside;
            double harmonic = 0.0;
            for (int64_t k = 2; k <= TAIL; ++k) harmonic += 1.0 / double(k);
            const double unit = (inside - at(voxels - 1 + TAIL)) / harmonic;
            return gap > std::max({MIN_SHARE * range, MIN_UNITS * unit, MIN_STEPS * largest_step(last + 1)});
        });
    }

    /// Excludes the outermost values, up to MAX_FILL_VALUES, if `are_fill(value, gap / range)` is true for all of them.
    template <class AreFill>
    bool exclude_fill(double other_end, const AreFill& are_fill)
    {
        for (size_t last = std::min(first_ + MAX_FILL_VALUES, values_.size() - 1); last-- > first_;) {
            const double inside = values_[last + 1].value;
            const double range = half_distance(inside, other_end);
            const double gap = half_distance(values_[last].value, inside) / range;
            const auto begin = values_.begin() + std::ptrdiff_t(first_);
            const auto end = values_.begin() + std::ptrdiff_t(last) + 1;
            if (!(range > 0.0) || !std::all_of(begin, end, [&](const ValueCount& each) {
                    return each.voxels >= MIN_VOXELS_OF_FILL && are_fill(each.value, gap);
                }))
                continue;
            fill_.insert(fill_.end(), begin, end);
            first_ = last + 1;
            return true;
        }
        return false;
    }

private:
    /// Excludes all values from outermost to innermost with `is_last(index, voxels up to it)`, up to `limit` voxels.
    template <class IsLast>
    void exclude_beyond(int64_t limit, const IsLast& is_last)
    {
        size_t end = first_;
        int64_t voxels = 0;
        while (end + 1 < values_.size() && voxels + values_[end].voxels <= limit) voxels += values_[end++].voxels;
        for (; end > first_; voxels -= values_[--end].voxels) {
            if (!is_last(end - 1, voxels)) continue;
            outliers_ += voxels;
            first_ = end;
            return;
        }
    }

    /// Returns the largest distance between two successive values, among the STEPS distinct values from index `from`.
    double largest_step(size_t from) const
    {
        double largest = 0.0;
        for (size_t i = from; i + 1 < values_.size() && i < from + STEPS; ++i)
            largest = std::max(largest, values_[i].value - values_[i + 1].value);
        return largest;
    }

    std::vector<ValueCount> values_;
    size_t first_ = 0;  ///< the first that is not excluded
    int64_t outliers_ = 0;
    std::vector<ValueCount> fill_{};
};

// ---- The largest values ---------------------------------------------------------------------------------------------

namespace {

void sort_and_merge(std::vector<ValueCount>& values)
{
    std::ranges::sort(values, std::greater<>(), &ValueCount::value);
    size_t last = 0;
    for (size_t i = 1; i < values.size(); ++i) {
        if (values[i].value == values[last].value)
            values[last].voxels += values[i].voxels;
        else
            values[++last] = values[i];
    }
    if (!values.empty()) values.resize(last + 1);
}

}  // namespace

void OutlierFinder::Largest::append(double value, int64_t times)
{
    if (value > most_.value) {
        std::swap(value, most_.value);
        std::swap(times, most_.voxels);
        if (times == 0) return;
    }
    others_.push_back({value, times});
    if (others_.size() >= 2 * kept_) shrink();
}

void OutlierFinder::Largest::shrink()
{
    sort_and_merge(others_);
    if (others_.size() < kept_) return;
    others_.resize(kept_);
    least_ = others_.back().value;
}

std::vector<ValueCount> OutlierFinder::Largest::sorted() const
{
    std::vector<ValueCount> all = others_;
    if (most_.voxels > 0) all.push_back(most_);
    sort_and_merge(all);
    return all;
}

// ---- Outliers and fill values ---------------------------------------------------------------------------------------

OutlierFinder::OutlierFinder(int64_t voxels, VoxelType type, std::optional<double> nodata)
    : type_(type),
      nodata_(nodata.value_or(std::numeric_limits<double>::infinity())),
      finds_fill_(!nodata),
      largest_(size_t(FAR.limit(voxels) + 2 * NEAR.limit(voxels) + TAIL + 1) + 2 * MAX_FILL_VALUES),
      smallest_(largest_)
{}

bool OutlierFinder::is_fill_like(double value, bool has_exact_codes, double gap) const
{
    if (value == 0.0) return false;
    if (is_extreme(type_, value)) return gap >= MIN_GAP_OF_EXTREME;
    if (has_exact_codes && (value > 0.0 || bytes_of(type_) == 1)) return false;
    return gap >= MIN_GAP_OF_FILL;
}

void OutlierFinder::exclude_strays(End& upper, End& lower, bool has_exact_codes) const
{
    const bool is_continuous = upper.different(MIN_VALUES_AT_END - 1) > -lower.different(MIN_VALUES_AT_END - 1);
    for (const Rule& rule : {FAR, NEAR}) {
        if (!is_continuous && (has_exact_codes || rule.gap == NEAR.gap)) continue;
        const int64_t limit = rule.limit(count_);
        const double upper_end = upper.at(limit), lower_end = -lower.at(limit);
        // If nearly all voxels have one value, the few other voxels are structures, not outliers.
        if (!(lower_end < upper_end)) continue;
        upper.exclude(rule, limit, lower_end);
        lower.exclude(rule, limit, -upper_end);
    }
}

bool OutlierFinder::exclude_fill(End& upper, End& lower, bool has_exact_codes) const
{
    const auto exclude = [&](End& end, const End& other, double sign) {
        End without = end;
        if (!without.exclude_fill(-other.outermost(), [&](double value, double gap) {
                return is_fill_like(sign * value, has_exact_codes, gap);
            }))
            return false;
        // At least MIN_VALUES_AT_END distinct values must remain; fewer would be labels.
        if (!(without.different(MIN_VALUES_AT_END - 1) > -other.different(MIN_VALUES_AT_END - 1))) return false;
        if (count_ - without.fill_voxels() - other.fill_voxels() < MIN_VOXELS) return false;
        end = std::move(without);
        return true;
    };
    const bool has_lower = exclude(lower, upper, -1.0);
    return exclude(upper, lower, 1.0) || has_lower;
}

std::optional<OutlierFinder::Bulk> OutlierFinder::bulk()
{
    std::vector<ValueCount> fill;
    if (nodata_voxels_ > 0) fill.push_back({nodata_, nodata_voxels_});
    if (count_ == 0) return std::nullopt;
    End upper(largest_), lower(smallest_);
    if (count_ >= MIN_VOXELS) {
        const bool has_exact_codes =
            !is_float(type_) && half_distance(upper.at_start(), -lower.at_start()) <= 0.5 * 65535.0;
        exclude_strays(upper, lower, has_exact_codes);
        // Fill values widen the range, which hides outliers at the other end: searches again without them.
        if (finds_fill_ && exclude_fill(upper, lower, has_exact_codes)) {
            exclude_strays(upper, lower, has_exact_codes);
            exclude_fill(upper, lower, has_exact_codes);
        }
        const bool is_continuous = upper.different(MIN_VALUES_AT_END - 1) > -lower.different(MIN_VALUES_AT_END - 1);
        if (count_ >= MIN_VOXELS_OF_TAIL && is_continuous) {
            const int64_t limit = NEAR.limit(count_);
            const double range = 2.0 * half_distance(upper.at(limit), -lower.at(limit));
            if (range > 0.0) {
                upper.exclude_isolated(limit, range);
                lower.exclude_isolated(limit, range);
            }
        }
    }
    for (const ValueCount& each : lower.fill()) fill.push_back({-each.value, each.voxels});
    fill.insert(fill.end(), upper.fill().begin(), upper.fill().end());
    const int64_t outliers = upper.outliers() + lower.outliers();
    if (outliers == 0 && fill.empty()) return std::nullopt;
    return Bulk{{-lower.outermost(), upper.outermost()}, outliers, std::move(fill)};
}

}  // namespace shvr
