#include "engine/workbench/curves/histogram_bars.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace shvr::ui {

namespace {

constexpr int64_t MAX_VALUES = 65536;  ///< number of values of a 16-bit integer

/// Returns the bin to which VolumeSource::measure assigns a value; values are relative to the volume's minimum.
size_t bin_of(double value, int64_t span, size_t bins)
{
    return std::min(bins - 1, size_t(value / double(span) * double(bins)));
}

/// Assumed set of possible voxel values: from 0 to `span` in `intervals` equal steps, each value rounded down or up.
struct Lattice {
    int64_t span = 1, intervals = 1;
    double step() const { return double(span) / double(intervals); }
    double lower(int64_t k) const { return std::floor(double(k) * double(span) / double(intervals)); }
    double upper(int64_t k) const { return std::ceil(double(k) * double(span) / double(intervals)); }
};

/// Counts the assumed values per bin. A value that rounding may move into another bin counts in both bins.
std::vector<int64_t> values_in_bins(const Lattice& lattice, size_t bins)
{
    std::vector<int64_t> values(bins, 0);
    for (int64_t k = 0; k <= lattice.intervals; ++k) {
        const size_t first = bin_of(lattice.lower(k), lattice.span, bins);
        const size_t last = bin_of(lattice.upper(k), lattice.span, bins);
        ++values[first];
        if (last != first) ++values[last];
    }
    return values;
}

/// Returns whether voxels lie in a bin that contains none of the assumed values, which proves the assumption wrong.
bool is_refuted(const std::vector<int64_t>& values, const std::vector<int64_t>& counts)
{
    for (size_t bin = 0; bin < counts.size(); ++bin)
        if (counts[bin] > 0 && values[bin] == 0) return true;
    return false;
}

/// Returns how much the logarithm of (voxels per assumed value) varies from bin to bin, summed over the histogram.
double roughness(const std::vector<int64_t>& values, const std::vector<int64_t>& counts)
{
    double sum = 0.0, last = std::numeric_limits<double>::quiet_NaN();
    for (size_t bin = 0; bin < counts.size(); ++bin) {
        if (values[bin] == 0) continue;
        const double height = std::log1p(double(counts[bin]) / double(values[bin]));
        if (!std::isnan(last)) sum += std::abs(height - last);
        last = height;
    }
    return sum;
}

/// Finds the largest step of voxel values that the histogram is consistent with. `span` is always one of the values.
Lattice lattice_of(int64_t span, const std::vector<int64_t>& counts)
{
    const double bin_width = double(span) / double(counts.size());
    // If the step is wider than a bin, bins between two values are empty. As a rounded value may fall into either of
    // two bins, a step is accepted even though some bins that contain an assumed value are empty.
    for (int64_t intervals = 1; double(span) > bin_width * double(intervals); ++intervals) {
        const Lattice lattice{span, intervals};
        const bool is_apart = span % intervals == 0 || lattice.step() >= std::max(4.0 * bin_width, 3.0);
        if (is_apart && !is_refuted(values_in_bins(lattice, counts.size()), counts)) return lattice;
    }
    // If the step is narrower than a bin, the number of values per bin varies by one, so the histogram looks like a
    // comb. Counts divided by the number of values per bin are smooth only for the right step.
    constexpr double CLEARLY = 0.6;
    Lattice best{span, span};
    double least = CLEARLY * roughness(values_in_bins(best, counts.size()), counts);
    for (int64_t step = 2; double(step) <= bin_width; ++step) {
        const Lattice lattice{span, span / step};
        if (span % step != 0) continue;
        if (const double rough = roughness(values_in_bins(lattice, counts.size()), counts); rough < least)
            best = lattice, least = rough;
    }
    return best;
}

/// Adds a bar for each value; the bar extends halfway to the neighbouring values.
void add_values(const Lattice& lattice, double lowest, const std::vector<int64_t>& counts, HistogramBars& made)
{
    for (int64_t k = 0; k <= lattice.intervals; ++k) {
        const size_t first = bin_of(lattice.lower(k), lattice.span, counts.size());
        const size_t last = bin_of(lattice.upper(k), lattice.span, counts.size());
        const int64_t voxels = counts[first] + (last != first ? counts[last] : 0);
        const double middle = lowest + double(k) * lattice.step(), half = 0.5 * lattice.step();
        made.bars.push_back({middle - half, middle + half, double(voxels)});
    }
}

/// Closes small gaps, which arise if a scan was brightened, or otherwise mapped by a curve that skips some values.
/// Extends each bar that has voxels halfway to the next bar that has voxels.
void join_small_gaps(std::vector<HistogramBar>& bars)
{
    constexpr size_t MAX_GAP = 2;    // consecutive empty bars
    constexpr size_t MIN_SHARE = 4;  // bars are joined if gaps hold at least one bar for every MIN_SHARE filled bars
    std::vector<size_t> filled;
    for (size_t i = 0; i < bars.size(); ++i)
        if (bars[i].voxels > 0.0) filled.push_back(i);
    size_t left_out = 0;
    for (size_t k = 1; k < filled.size(); ++k)
        if (filled[k] - filled[k - 1] - 1 <= MAX_GAP) left_out += filled[k] - filled[k - 1] - 1;
    if (left_out * MIN_SHARE < filled.size()) return;
    std::vector<HistogramBar> joined;
    for (size_t k = 0; k < filled.size(); ++k) {
        HistogramBar bar = bars[filled[k]];
        const double width = bar.upper - bar.lower;
        if (k > 0 && filled[k] - filled[k - 1] - 1 <= MAX_GAP)
            bar.lower = 0.5 * (bars[filled[k - 1]].upper + bar.lower);
        if (k + 1 < filled.size() && filled[k + 1] - filled[k] - 1 <= MAX_GAP)
            bar.upper = 0.5 * (bars[filled[k]].upper + bars[filled[k + 1]].lower);
        bar.voxels *= width / (bar.upper - bar.lower);
        joined.push_back(bar);
    }
    bars = std::move(joined);
}

}  // namespace

HistogramBars histogram_bars(VoxelType type, const VolumeStatistics& statistics)
{
    HistogramBars made;
    const std::vector<int64_t>& counts = statistics.histogram;
    const ValueRange range = statistics.range();
    for (const ValueCount& each : statistics.fill) made.fill.push_back({each.value, each.value, double(each.voxels)});
    if (counts.empty() || !(range.upper > range.lower)) return made;
    const double width = (range.upper - range.lower) / double(counts.size());
    const auto bin_at = [&](size_t bin) { return range.lower + double(bin) * width; };
    const bool is_counted = !is_float(type) && range.upper - range.lower < double(MAX_VALUES) &&
                            range.lower == std::floor(range.lower) && range.upper == std::floor(range.upper);
    if (!is_counted) {
        for (size_t bin = 0; bin < counts.size(); ++bin)
            made.bars.push_back({bin_at(bin), bin_at(bin + 1), double(counts[bin])});
        return made;
    }
    const Lattice lattice = lattice_of(int64_t(range.upper - range.lower), counts);
    made.step = lattice.step();
    if (made.step > width) {
        add_values(lattice, range.lower, counts, made);
        if (made.step == 1.0) join_small_gaps(made.bars);
        return made;
    }
    const std::vector<int64_t> values = values_in_bins(lattice, counts.size());
    for (size_t bin = 0; bin < counts.size(); ++bin)
        if (values[bin] > 0)
            made.bars.push_back({bin_at(bin), bin_at(bin + 1), double(counts[bin]) / double(values[bin])});
    return made;
}

double height_of_bar(double voxels, double most, bool is_logarithmic)
{
    if (!(most > 0.0) || !(voxels > 0.0)) return 0.0;
    return std::min(is_logarithmic ? std::log1p(voxels) / std::log1p(most) : voxels / most, 1.0);
}

}  // namespace shvr::ui
