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
        REQUIRE(found.has_value() == expected.has_value());
        CHECK(found.has_value() == (strays == 3));
        if (!found) continue;
        CHECK(found->range == range_of(values));
        CHECK(found->outliers == strays);
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
