// Bars that suit what voxels can be: no comb where the volume has none.

#include "engine/workbench/curves/histogram_bars.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

/// A smooth hill of values from 0 to `top`, each a multiple of `step`, in 256 bins as volumes are measured.
VolumeStatistics hill(int top, int step)
{
    VolumeStatistics statistics{.minimum = 0.0, .maximum = double(top)};
    statistics.histogram.assign(256, 0);
    for (int value = 0; value <= top; value += step) {
        const double away = (value - 0.4 * top) / (0.2 * top);
        const auto count = int64_t(100000.0 * std::exp(-away * away)) + 10;
        statistics.histogram[std::min<size_t>(255, size_t(double(value) / top * 256.0))] += count;
    }
    return statistics;
}

/// The largest factor between a bar and the next that it touches, of those that are not nearly empty.
double largest_leap(const HistogramBars& bars)
{
    double leap = 1.0;
    for (size_t i = 0; i + 1 < bars.bars.size(); ++i) {
        const double a = bars.bars[i].voxels, b = bars.bars[i + 1].voxels;
        const bool touch = std::abs(bars.bars[i + 1].lower - bars.bars[i].upper) < 1e-9;
        if (touch && std::max(a, b) > 2000.0) leap = std::max(leap, std::max(a, b) / std::max(std::min(a, b), 1e-9));
    }
    return leap;
}

}  // namespace

TEST_CASE("a smooth histogram is drawn smooth, whatever the values are multiples of and however many there are")
{
    struct Case {
        int top, step;
    };
    for (const Case& each : {Case{300, 1}, Case{255, 1}, Case{100, 1}, Case{1000, 1}, Case{4000, 16}, Case{2000, 20},
                             Case{65520, 16}, Case{600, 2}, Case{2040, 8}}) {
        CAPTURE(each.top);
        CAPTURE(each.step);
        const HistogramBars bars = histogram_bars(VoxelType::uint16, hill(each.top, each.step));
        CHECK(largest_leap(bars) < 1.8);  // from one to the next value of a coarse one, the hill itself rises by 1.6
    }
}

// Kind (Values): a fill value in the histogram
TEST_CASE("a fill value has a bar of its own, apart from all others")
{
    VolumeStatistics statistics = hill(300, 1);
    const size_t bars = histogram_bars(VoxelType::int32, statistics).bars.size();
    statistics.minimum = -2147483648.0;
    statistics.bulk = ValueRange{0.0, 300.0};
    statistics.fill = {{-2147483648.0, 5000}};
    const HistogramBars made = histogram_bars(VoxelType::int32, statistics);
    CHECK(made.bars.size() == bars);
    REQUIRE(made.fill.size() == 1);
    CHECK(made.fill[0].lower == -2147483648.0);
    CHECK(made.fill[0].voxels == 5000.0);
}

TEST_CASE("values that lie apart have a bar each, centred on them")
{
    const HistogramBars bars = histogram_bars(VoxelType::int16, hill(4000, 20));
    CHECK(bars.step == 20);
    REQUIRE(bars.bars.size() == 201);
    CHECK(bars.bars[0].lower == -10.0);
    CHECK(bars.bars[0].upper == 10.0);
    CHECK(bars.bars[200].lower == 3990.0);
    CHECK(bars.bars[200].upper == 4010.0);
    for (size_t i = 0; i + 1 < bars.bars.size(); ++i) CHECK(bars.bars[i].upper == bars.bars[i + 1].lower);
}

TEST_CASE("values that were rounded from steps of a fraction have a bar each, too")
{
    // Like the stent of the examples: 33 values from 0 to 2000 in steps of 62.5, rounded down.
    VolumeStatistics statistics{.minimum = 0.0, .maximum = 2000.0};
    statistics.histogram.assign(256, 0);
    for (int k = 0; k <= 32; ++k)
        statistics.histogram[std::min<size_t>(255, size_t(std::floor(62.5 * k) / 2000.0 * 256.0))] += 1000 + k;
    const HistogramBars bars = histogram_bars(VoxelType::int16, statistics);
    CHECK(bars.step == 62.5);
    REQUIRE(bars.bars.size() == 33);
    for (int k = 0; k <= 32; ++k) CHECK(bars.bars[size_t(k)].voxels == 1000.0 + k);
    CHECK(bars.bars[1].lower == 31.25);
    CHECK(bars.bars[1].upper == 93.75);
}

TEST_CASE("values that a curve has spread are joined over what it left out, and real gaps stay")
{
    // 156 values through a gamma of 0.9, as in the barley spike of the tests' scans: 0, 1, 5, 7, ... of 255.
    VolumeStatistics statistics{.minimum = 0.0, .maximum = 255.0};
    statistics.histogram.assign(256, 0);
    for (int k = 0; k <= 155; ++k) {
        if (k > 30 && k < 50) continue;
        const double away = (k - 90.0) / 40.0, value = std::floor(255.0 * std::pow(k / 155.0, 0.9));
        statistics.histogram[std::min<size_t>(255, size_t(value / 255.0 * 256.0))] +=
            int64_t(100000.0 * std::exp(-away * away));
    }
    const HistogramBars bars = histogram_bars(VoxelType::uint8, statistics);
    CHECK(bars.step == 1.0);
    CHECK(bars.bars.size() == 137);
    CHECK(largest_leap(bars) < 1.8);
    size_t gaps = 0;
    for (size_t i = 0; i + 1 < bars.bars.size(); ++i) gaps += bars.bars[i + 1].lower > bars.bars[i].upper + 1e-9;
    CHECK(gaps >= 1);
    CHECK(gaps <= 3);  // near 0 the curve is steep
}

TEST_CASE("a few whole numbers have a bar each, and every voxel is in one")
{
    const VolumeStatistics statistics = hill(100, 1);
    const HistogramBars bars = histogram_bars(VoxelType::uint8, statistics);
    CHECK(bars.step == 1);
    REQUIRE(bars.bars.size() == 101);
    double sum = 0.0;
    for (const HistogramBar& bar : bars.bars) sum += bar.voxels;
    int64_t voxels = 0;
    for (const int64_t count : statistics.histogram) voxels += count;
    CHECK(sum == double(voxels));
}

TEST_CASE("floats keep the bins that they were measured in")
{
    VolumeStatistics statistics{.minimum = -1.0, .maximum = 1.0};
    statistics.histogram.assign(256, 7);
    statistics.histogram[3] = 0;
    const HistogramBars bars = histogram_bars(VoxelType::float32, statistics);
    CHECK(bars.step == 0);
    REQUIRE(bars.bars.size() == 256);
    CHECK(bars.bars[3].voxels == 0.0);
    CHECK(bars.bars[4].voxels == 7.0);
    CHECK(histogram_bars(VoxelType::uint8, {}).bars.empty());
    VolumeStatistics one{.minimum = 5.0, .maximum = 5.0};
    one.histogram.assign(256, 0);
    CHECK(histogram_bars(VoxelType::uint8, one).bars.empty());
}

TEST_CASE("a gap in a histogram is no step")
{
    VolumeStatistics statistics = hill(4095, 1);
    for (size_t bin = 100; bin < 140; ++bin) statistics.histogram[bin] = 0;
    CHECK(histogram_bars(VoxelType::uint16, statistics).step == 1);
}

TEST_CASE("bars are as high as voxels are many, or as their logarithm is")
{
    CHECK(height_of_bar(50.0, 100.0, false) == 0.5);
    CHECK(height_of_bar(100.0, 100.0, true) == 1.0);
    CHECK(height_of_bar(9.0, 99.0, true) == doctest::Approx(0.5));
    CHECK(height_of_bar(0.0, 99.0, true) == 0.0);
    CHECK(height_of_bar(5.0, 0.0, false) == 0.0);
}
