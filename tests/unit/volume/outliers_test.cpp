#include "engine/volume/outliers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <doctest/doctest.h>

#include "engine/volume/source.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Tissue: a normal distribution of 100 +- 10.
std::vector<double> tissue(size_t voxels, uint32_t seed = 1)
{
    std::mt19937 random(seed);
    std::normal_distribution<double> intensity(100.0, 10.0);
    std::vector<double> values(voxels);
    for (double& value : values) value = intensity(random);
    return values;
}

/// In an order that does not depend on the values.
std::optional<OutlierFinder::Bulk> bulk_of(std::vector<double> values)
{
    std::ranges::shuffle(values, std::mt19937(5));
    OutlierFinder finder(int64_t(values.size()));
    for (const double value : values) finder.add(value);
    return finder.bulk();
}

ValueRange range_of(const std::vector<double>& values)
{
    const auto [least, most] = std::ranges::minmax(values);
    return {least, most};
}

}  // namespace

TEST_CASE("stray values are left out of a range whatever the number of voxels")
{
    for (const size_t voxels : {27, 125, 512, 999, 8000, 64000, 99999, 216000, 1000000})
        for (const std::vector<double>& stray :
             {std::vector{1e30}, {-1e30}, {1e9}, {std::numeric_limits<double>::max()}, {-1e30, 1e30}}) {
            CAPTURE(voxels);
            CAPTURE(stray.front());
            std::vector<double> values = tissue(voxels);
            CHECK_FALSE(bulk_of(values).has_value());
            const ValueRange expected = range_of(values);
            values.insert(values.end(), stray.begin(), stray.end());
            const std::optional<OutlierFinder::Bulk> found = bulk_of(values);
            REQUIRE(found.has_value());
            CHECK(found->range == expected);
            CHECK(found->outliers == int64_t(stray.size()));
        }
}

// Kind (Values): a few stray values far from all others
TEST_CASE("several stray values are left out while they are few")
{
    const std::vector<double> plain = tissue(60 * 60 * 60);
    for (const size_t count : {2, 3, 8, 21, 22, 2160}) {
        CAPTURE(count);
        std::vector<double> values = plain;
        for (size_t i = 0; i < count; ++i) values[i * 97] = 1e30 * double(1 + i);
        const std::optional<OutlierFinder::Bulk> found = bulk_of(values);
        REQUIRE(found.has_value() == (count <= 21));  // a ten thousandth of them
        if (found) CHECK(found->outliers == int64_t(count));
        if (found) CHECK(found->range.upper < 200.0);
    }
    // A hot pixel in addition to fill values: removed one after the other.
    std::vector<double> values = plain;
    values[7] = values[8] = values[9] = 1e30;
    values[10] = 1000.0;
    CHECK(bulk_of(values).value().outliers == 4);
}

// Kind (Values): rare bright voxels that belong to the scan
TEST_CASE("what is rare and bright in a scan stays in the range")
{
    const std::vector<double> plain = tissue(60 * 60 * 60);
    std::mt19937 random(2);
    SUBCASE("metal: 1 % of the voxels, a hundred times as bright")
    {
        std::vector<double> values = plain;
        for (size_t i = 0; i < values.size(); i += 100) values[i] *= 100.0;
        CHECK_FALSE(bulk_of(values).has_value());
    }
    SUBCASE("a vessel one voxel thick, five thousand times as bright, in volumes of any size")
    {
        for (const size_t side : {10, 20, 40, 60}) {
            std::vector<double> values = tissue(side * side * side);
            for (size_t i = 0; i < side; ++i) values[i] *= 5000.0;
            CHECK_FALSE(bulk_of(values).has_value());
        }
    }
    SUBCASE("a bright speck with voxels that hold a part of it")
    {
        std::vector<double> values = plain;
        double part = 200.0;
        for (size_t i = 0; i < 8; ++i, part *= 4.0) values[i] = part;
        CHECK_FALSE(bulk_of(values).has_value());
    }
    SUBCASE("a few labels, and nothing else")
    {
        for (const double background : {0.0, -5.0, 5.0, 1e-3}) {
            std::vector<double> values(1000000, background);
            values[500] = 1e6;
            values[501] = 3.0;
            CHECK_FALSE(bulk_of(values).has_value());
        }
    }
}

TEST_CASE("the range without stray values is exact in any order, and of any size")
{
    std::vector<double> values(100000);
    std::iota(values.begin(), values.end(), -5000.0);
    values[0] = -std::numeric_limits<double>::max();
    values[1] = std::numeric_limits<double>::max();
    for (const bool is_descending : {false, true}) {
        if (is_descending) std::ranges::sort(values, std::greater<>());
        OutlierFinder finder(int64_t(values.size()));
        for (const double value : values) finder.add(value);
        const std::optional<OutlierFinder::Bulk> found = finder.bulk();
        REQUIRE(found.has_value());
        CHECK(found->range == ValueRange{-4998.0, 94999.0});
        CHECK(found->outliers == 2);
    }
    CHECK_FALSE(bulk_of({}).has_value());
    CHECK_FALSE(bulk_of({1.0, 2.0, 3.0, 1e30}).has_value());  // four values cannot show which is usual
}

TEST_CASE("a value that occurs many times counts as often")
{
    for (const int strays : {3, 5000}) {
        CAPTURE(strays);
        std::vector<double> values = tissue(2000);
        OutlierFinder counted(300 * 2000 + strays);
        std::vector<double> all(size_t(strays), 1e30);
        for (size_t i = 0; i < values.size(); ++i) {
            const size_t times = i % 2 == 0 ? 1 : 599;
            counted.add(values[i], int64_t(times));
            all.insert(all.end(), times, values[i]);
            if (i == 1000) counted.add(1e30, strays);
        }
        const std::optional<OutlierFinder::Bulk> found = counted.bulk(), expected = bulk_of(all);
        REQUIRE(found.has_value());
        REQUIRE(expected.has_value());
        CHECK(found->range == range_of(values));
        CHECK(expected->range == found->range);
        CHECK(found->fill == expected->fill);
        CHECK(found->outliers == (strays == 3 ? 3 : 0));
        if (strays > 3) CHECK(found->fill == std::vector<ValueCount>{{1e30, strays}});
    }
    // The few values that a sparse volume stores are not left out.
    OutlierFinder sparse(int64_t{1} << 60);
    for (const double value : tissue(1000)) sparse.add(value);
    sparse.add(0.0, (int64_t{1} << 60) - 1000);
    CHECK_FALSE(sparse.bulk().has_value());
}

TEST_CASE("a small float volume says what it leaves out, in one number or several")
{
    for (const int count : {1, 3}) {
        std::vector<float> voxels(20 * 20 * 20);
        for (size_t i = 0; i < voxels.size(); ++i) voxels[i] = float(i % 100);
        for (int i = 0; i < count; ++i) voxels[size_t(100 + i * 100)] = 1e30f;
        const VolumeStatistics found = measure(memory_source({20, 20, 20}, VoxelType::float32, voxels));
        CHECK(found.range() == ValueRange{0.0, 99.0});
        CHECK(found.histogram[0] == 80 - count);
        CHECK(found.histogram[255] == 80 + count);
        REQUIRE(warnings_of(found).size() == 1);
        CHECK(warnings_of(found)[0] ==
              (count == 1 ? "1 voxel lies far outside 0 to 99, where all others are (with it the range is 0 to 1e+30), "
                            "and is shown as if it were at the nearer end of that range"
                          : "3 voxels lie far outside 0 to 99, where all others are (with them the range is 0 to "
                            "1e+30), and are shown as if they were at the nearer end of that range"));
    }
}

// ---- Fill values ----------------------------------------------------------------------------------------------------

namespace {

/// Tissue of whole numbers from `lower` to `upper`; every n-th voxel of it has the fill value, n = 1 / share.
std::vector<double> filled(double lower, double upper, double fill, double share)
{
    std::vector<double> values(40 * 40 * 40);
    uint32_t state = 1;
    double due = 0.0;
    for (double& value : values) {
        state = state * 1664525u + 1013904223u;
        value = lower + double((state >> 8) % uint32_t(upper - lower + 1.0));
        if ((due += share) < 1.0) continue;
        due -= 1.0;
        value = fill;
    }
    return values;
}

std::optional<OutlierFinder::Bulk> bulk_of(VoxelType type, const std::vector<double>& values,
                                           std::optional<double> nodata = {})
{
    OutlierFinder finder(int64_t(values.size()), type, nodata);
    for (const double value : values) finder.add(value);
    return finder.bulk();
}

}  // namespace

// Kind (Values): a fill value at an end of the range, at any share
TEST_CASE("a fill value of any share is found at either end, and the rest keeps its range")
{
    struct Case {
        VoxelType type;
        double fill;
    };
    for (const Case& each : {Case{VoxelType::int32, -2147483648.0},
                             {VoxelType::int32, 10000000.0},
                             {VoxelType::uint32, 4294967295.0},
                             {VoxelType::float32, double(-3.4e38f)},
                             {VoxelType::float32, -9999.0},
                             {VoxelType::float64, 1e20},
                             {VoxelType::int16, -32768.0},
                             {VoxelType::uint16, 65535.0},
                             {VoxelType::int16, -9999.0}})
        for (const double share : {0.0002, 0.002, 0.08, 0.3, 0.9, 0.999}) {
            CAPTURE(name_of(each.type));
            CAPTURE(each.fill);
            CAPTURE(share);
            const std::vector<double> values = filled(1, 120, each.fill, share);
            const std::optional<OutlierFinder::Bulk> found = bulk_of(each.type, values);
            REQUIRE(found.has_value());
            CHECK(found->range.lower >= 1.0);
            CHECK(found->range.upper <= 120.0);
            const int64_t count = std::ranges::count(values, each.fill);
            if (!found->fill.empty()) CHECK(found->fill == std::vector<ValueCount>{{each.fill, count}});
            CHECK(found->outliers + (found->fill.empty() ? 0 : count) == count);
            if (share >= 0.002) CHECK_FALSE(found->fill.empty());
        }
}

// Kind (Values): two fill values, and a hot voxel next to one
TEST_CASE("two fill values, and a hot voxel next to one, are told apart")
{
    std::vector<double> values = filled(1, 120, -9999.0, 0.1);
    for (size_t i = 5; i < values.size(); i += 50) values[i] = -9998.0;
    values[77] = 60000.0;
    const std::optional<OutlierFinder::Bulk> found = bulk_of(VoxelType::float32, values);
    REQUIRE(found.has_value());
    CHECK(found->range == ValueRange{1.0, 120.0});
    CHECK(found->outliers == 1);
    CHECK(found->fill.size() == 2);
}

// Kind (Values): air at 0, labels, two materials and saturation, which are no fill values
TEST_CASE("air at 0, labels, two materials and saturation are no fill values")
{
    const auto has_none = [](VoxelType type, const std::vector<double>& values) {
        const std::optional<OutlierFinder::Bulk> found = bulk_of(type, values);
        CHECK((!found || found->fill.empty()));
    };
    for (const VoxelType type : {VoxelType::uint16, VoxelType::int32, VoxelType::float32})
        for (const double share : {0.01, 0.5, 0.95}) {
            CAPTURE(name_of(type));
            CAPTURE(share);
            has_none(type, filled(1000, 1040, 0.0, share));  // air around an object of nearly one intensity
            has_none(type, filled(100, 200, 255.0, share));  // saturation
            has_none(type, filled(1, 9, 1000000.0, share));  // ten labels
            has_none(type, filled(7, 7, 9000.0, share));     // two materials
        }
    has_none(VoxelType::uint16, filled(1, 60, 9000.0, 0.1));  // labels with exact codes
    has_none(VoxelType::uint8, filled(100, 105, 255.0, 0.1));
}

// Kind (Values): a fill value that the user states
TEST_CASE("a stated fill value is the only one, wherever it lies, and infinity states none")
{
    const std::vector<double> values = filled(1, 120, -9999.0, 0.25);
    const int64_t count = std::ranges::count(values, 60.0);
    const std::optional<OutlierFinder::Bulk> within = bulk_of(VoxelType::int16, values, 60.0);
    REQUIRE(within.has_value());
    CHECK(within->fill == std::vector<ValueCount>{{60.0, count}});
    CHECK(within->range == ValueRange{-9999.0, 120.0});
    CHECK_FALSE(bulk_of(VoxelType::int16, values, std::numeric_limits<double>::infinity()).has_value());
}

TEST_CASE("the histogram and the mean leave a fill value out, and a warning says so")
{
    const std::vector<double> values = filled(1, 120, -2147483648.0, 0.08);
    std::vector<int32_t> voxels(values.begin(), values.end());
    const VolumeStatistics found = measure(memory_source({40, 40, 40}, VoxelType::int32, voxels));
    CHECK(found.minimum == -2147483648.0);
    CHECK(found.range() == ValueRange{1.0, 120.0});
    CHECK(found.mean > 50.0);
    CHECK(found.mean < 70.0);
    CHECK(std::accumulate(found.histogram.begin(), found.histogram.end(), int64_t{0}) + found.fill.at(0).voxels ==
          64000);
    CHECK(found.beyond_bulk == 0);
    CHECK(window_for(VoxelType::int32, found).codes_per_unit >= 1.0);
    REQUIRE(warnings_of(found).size() == 1);
    CHECK(contains(warnings_of(found)[0], " voxels have the value -2147483648, far outside all others"));
}
