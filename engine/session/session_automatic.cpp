#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/look/session_color.h"
#include "engine/session/session.h"
#include "engine/session/session_keys.h"

namespace shvr {
namespace {

/// The ramp reaches its end at this quantile of the voxels that it shows.
constexpr double FULL_QUANTILE = 0.9;

ControlPoint point(double intensity, const char* color, double opacity)
{
    return {intensity, glm::dvec3(color_of(color).value()), opacity};
}

/// Returns the number of bins in the lower class for which the variance between the classes is largest (Otsu 1979).
size_t otsu_split(const std::vector<int64_t>& histogram)
{
    double count = 0.0;
    double sum = 0.0;
    for (size_t bin = 0; bin < histogram.size(); ++bin) {
        count += double(histogram[bin]);
        sum += double(histogram[bin]) * double(bin);
    }
    double lower_count = 0.0;
    double lower_sum = 0.0;
    double best_variance = 0.0;
    size_t best_split = 1;
    for (size_t bin = 0; bin + 1 < histogram.size(); ++bin) {
        lower_count += double(histogram[bin]);
        lower_sum += double(histogram[bin]) * double(bin);
        const double upper_count = count - lower_count;
        if (lower_count == 0.0 || upper_count == 0.0) continue;
        const double distance = lower_sum / lower_count - (sum - lower_sum) / upper_count;
        const double variance = lower_count * upper_count * distance * distance;
        if (variance > best_variance) {
            best_variance = variance;
            best_split = bin + 1;
        }
    }
    return best_split;
}

/// Returns the end of the bins that, counted from `first`, hold at least a `share` of the voxels from `first` on.
size_t quantile_split(const std::vector<int64_t>& histogram, size_t first, double share)
{
    const auto begin = histogram.begin() + std::ptrdiff_t(first);
    const double wanted = share * double(std::accumulate(begin, histogram.end(), int64_t{0}));
    double found = 0.0;
    size_t bin = first;
    while (bin < histogram.size() && found < wanted) found += double(histogram[bin++]);
    return bin;
}

}  // namespace

double automatic_threshold(const TransferFunction& function, const VolumeStatistics& statistics)
{
    double weight = 0.0, sum = 0.0;
    for (const ControlPoint& point : function.points()) {
        weight += point.opacity;
        sum += point.opacity * point.intensity;
    }
    const auto [lower, upper] = statistics.range();
    const double middle = weight > 0.0 ? sum / weight : 0.5 * (lower + upper);
    return std::clamp(0.5 * (middle + function.lower()), lower, upper);
}

double automatic_node_radius(const VolumeInfo& info)
{
    constexpr double DIAGONAL_SHARE = 1.0 / 500.0;
    return std::max(DIAGONAL_SHARE * glm::length(glm::dvec3(info.size) * info.spacing) / info.spacing.x, 1.0);
}

namespace {

/// Widens the range if the volume has a single value, because a session requires that black is below white.
ValueRange contrast_between(double black, double white)
{
    if (black < white) return {black, white};
    const double half = std::max(0.5, 1e-6 * std::abs(black));
    return {std::max(black - half, INTENSITY.lower), std::min(black + half, INTENSITY.upper)};
}

}  // namespace

ValueRange automatic_contrast(const VolumeStatistics& statistics)
{
    constexpr double DARK_SHARE = 0.005, BRIGHT_SHARE = 0.0035;
    const auto [lower, upper] = statistics.range();
    const std::vector<int64_t>& histogram = statistics.histogram;
    if (!(lower < upper) || histogram.size() < 4) return contrast_between(lower, upper);
    const double bin = (upper - lower) / double(histogram.size());
    const size_t dark = quantile_split(histogram, 0, DARK_SHARE);  // the bins before `dark` hold 0.5 % of the voxels
    const size_t bright = quantile_split(histogram, 0, 1.0 - BRIGHT_SHARE);
    const double black = lower + bin * double(dark > 0 ? dark - 1 : 0), white = lower + bin * double(bright);
    return contrast_between(black, std::max(white, black + 2.0 * bin));
}

TissueRange tissue_range(const VolumeStatistics& statistics)
{
    const double minimum = statistics.range().lower;
    const double maximum = statistics.range().upper;
    const std::vector<int64_t>& histogram = statistics.histogram;
    // Without a useful histogram, or if all voxels are equal: the range around the single value.
    if (!(minimum < maximum) || histogram.size() < 4) return {minimum - 0.5, minimum + 0.5};
    const auto bins = double(histogram.size());
    const auto intensity_of = [&](size_t split) { return minimum + (maximum - minimum) * double(split) / bins; };
    const size_t median = quantile_split(histogram, 0, 0.5);
    const size_t lowest = std::min(std::max(otsu_split(histogram), median), histogram.size() - 2);
    const size_t full = std::clamp(quantile_split(histogram, lowest, FULL_QUANTILE), lowest + 1, histogram.size() - 1);
    return {intensity_of(lowest), intensity_of(full)};
}

TransferFunction automatic_transfer_function(const VolumeStatistics& statistics)
{
    const TissueRange tissue = tissue_range(statistics);
    const auto [minimum, maximum] = statistics.range();
    // No classes can be found: shows a thin haze, so that the picture is not empty.
    if (!(minimum < maximum) || statistics.histogram.size() < 4)
        return TransferFunction({point(tissue.lower, "#808080", 0.02), point(tissue.upper, "#808080", 0.02)});
    return TransferFunction(
        {point(tissue.lower, "#5c6066", 0.0), point(tissue.upper, "#e8a860", 0.3), point(maximum, "#fff4e0", 0.6)});
}

}  // namespace shvr
