// Automatic settings: dead and hot voxels, and what only looks like them.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "engine/session/session.h"
#include "engine/session/transfer_presets.h"
#include "engine/volume/voxel_numbers.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const Size3 SIZE(24, 24, 24);

VolumeStatistics measured(VoxelType type, const std::vector<double>& values)
{
    std::vector<std::byte> voxels(values.size() * bytes_of(type));
    store_voxels(type, values, voxels.data());
    return measure(memory_source(SIZE, type, voxels));
}

/// Uniform from `lower` to `upper`, in whole steps.
std::vector<double> tissue(double lower, double upper)
{
    std::vector<double> values(size_t(SIZE.x * SIZE.y * SIZE.z));
    uint32_t state = 1;
    for (double& value : values) {
        state = state * 1664525u + 1013904223u;
        value = lower + double((state >> 8) % uint32_t(upper - lower + 1.0));
    }
    return values;
}

/// Everything that is set by itself: the ramp, the threshold, the contrast of slices, every preset, the histogram's
/// range.
std::vector<double> settings_of(const VolumeStatistics& statistics)
{
    const TransferFunction ramp = automatic_transfer_function(statistics);
    std::vector<double> all{automatic_threshold(ramp, statistics), automatic_contrast(statistics).lower,
                            automatic_contrast(statistics).upper, statistics.range().lower, statistics.range().upper};
    for (const ControlPoint& point : ramp.points()) all.push_back(point.intensity);
    for (const TransferPreset& preset : transfer_presets()) {
        const TransferFunction function = transfer_function_of(preset, statistics);
        for (const ControlPoint& point : function.points()) all.push_back(point.intensity);
    }
    return all;
}

double farthest_apart(const std::vector<double>& a, const std::vector<double>& b)
{
    REQUIRE(a.size() == b.size());
    double most = 0.0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

}  // namespace

// Kind (Values): one dead or hot voxel, in any type
TEST_CASE("one dead or hot voxel of any type moves no automatic setting by 1 % of the tissue's range")
{
    struct Case {
        VoxelType type;
        double lower, upper;
        std::vector<double> strays;
    };
    const Case cases[] = {
        {VoxelType::uint8, 80, 180, {0, 255}},
        {VoxelType::int8, -30, 70, {-128, 127}},
        {VoxelType::uint16, 300, 600, {0, 150, 700, 1000, 4095, 65535}},
        {VoxelType::int16, -200, 300, {-32768, -1024, 1000, 32767}},
        {VoxelType::uint32, 3000, 6000, {0, 8000, 65535, 4294967295.0}},
        {VoxelType::int32, -300, 600, {-2147483648.0, -900, 1500, 2147483647.0}},
        {VoxelType::float32, 300, 600, {0, 750, 65535, 1e30, -1e30}},
        {VoxelType::float64, 300, 600, {0, 750, 65535, 1e300, -1e300}},
    };
    for (const Case& each : cases) {
        CAPTURE(name_of(each.type));
        const std::vector<double> plain = tissue(each.lower, each.upper);
        const std::vector<double> expected = settings_of(measured(each.type, plain));
        for (const double stray : each.strays) {
            CAPTURE(stray);
            std::vector<double> spoilt = plain;
            spoilt[4567] = stray;
            const VolumeStatistics statistics = measured(each.type, spoilt);
            CHECK(farthest_apart(settings_of(statistics), expected) < 0.01 * (each.upper - each.lower));
            CHECK(statistics.beyond_bulk == 1);
            CHECK(warnings_of(statistics).size() == 1);
        }
    }
}

TEST_CASE("integers of 16 bits keep codes of their own beside a hot voxel")
{
    std::vector<double> values = tissue(300, 600);
    values[99] = 65535;
    const VolumeStatistics statistics = measured(VoxelType::uint16, values);
    const IntensityWindow window = window_for(VoxelType::uint16, statistics);
    CHECK(window.intensity_of(window.threshold_code(65535.0)) == 65535.0);
    CHECK(window.codes_per_unit == 1.0);
    CHECK(contains(warnings_of(statistics).at(0),
                   "1 voxel lies far outside 300 to 600, where all others are (with it the range is 300 to 65535), and "
                   "counts neither for the histogram's range nor for automatic settings"));
}

TEST_CASE("labels, two values, air at 0 and saturation are no outliers")
{
    const auto is_whole = [](VoxelType type, const std::vector<double>& values) {
        const VolumeStatistics statistics = measured(type, values);
        CAPTURE(statistics.range().lower);
        CAPTURE(statistics.range().upper);
        CHECK_FALSE(statistics.bulk.has_value());
        CHECK(warnings_of(statistics).empty());
    };
    for (const VoxelType type : {VoxelType::uint8, VoxelType::uint16, VoxelType::int32, VoxelType::float32}) {
        CAPTURE(name_of(type));
        std::vector<double> labels = tissue(0, 5), many_labels = tissue(0, 99), sparse = tissue(0, 3);
        labels[7] = 6;         // labels of a single voxel
        many_labels[7] = 101;  // 100 is missing
        sparse[7] = 250;
        is_whole(type, labels);
        is_whole(type, many_labels);
        is_whole(type, sparse);
        std::vector<double> two(labels.size(), 0.0), air = tissue(100, 200), saturated = air;
        two[7] = 255;
        is_whole(type, two);
        for (size_t i = 0; i < air.size(); i += 2) air[i] = 0.0;
        is_whole(type, air);
        for (size_t i = 0; i < saturated.size(); i += 200) saturated[i] = 255.0;
        is_whole(type, saturated);
    }
}
