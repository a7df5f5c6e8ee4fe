#include "engine/volume/volume.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

#include <doctest/doctest.h>

#include "engine/volume/gaps.h"
#include "engine/volume/unit.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

uint32_t code(const IntensityWindow& window, double intensity)
{
    return uint32_t(std::lround(window.code_of(intensity)));
}

VolumeInfo info_of_size(const Size3& size)
{
    VolumeInfo info;
    info.name = "a.raw";
    info.size = size;
    return info;
}

}  // namespace

TEST_CASE("a voxel type is known by its own name and by those of the header formats")
{
    for (const VoxelType type : VOXEL_TYPES) CHECK(voxel_type_of(name_of(type)) == type);
    CHECK(bytes_of(VoxelType::int8) == 1);
    CHECK(bytes_of(VoxelType::uint16) == 2);
    CHECK(bytes_of(VoxelType::uint32) == 4);
    CHECK(bytes_of(VoxelType::float32) == 4);
    CHECK(bytes_of(VoxelType::float64) == 8);
    CHECK(voxel_type_of("UCHAR") == VoxelType::uint8);
    CHECK(voxel_type_of("MET_CHAR") == VoxelType::int8);
    CHECK(voxel_type_of("  unsigned   short int ") == VoxelType::uint16);
    CHECK(voxel_type_of("MET_SHORT") == VoxelType::int16);
    CHECK(voxel_type_of("MET_FLOAT") == VoxelType::float32);
    CHECK(voxel_type_of("MET_UINT") == VoxelType::uint32);
    CHECK(voxel_type_of("signed int") == VoxelType::int32);
    CHECK(voxel_type_of("double") == VoxelType::float64);
    for (const char* unknown : {"", " ", "int64", "uint64_t", "long", "MET_LONG", "longlong", "MET_ULONG_LONG", "MET_",
                                "met_met_short", "unsigned", "block"}) {
        CHECK_FALSE(voxel_type_of(unknown).has_value());
    }
}

TEST_CASE("the size of a voxel is said with signs between its sides, and with the unit as people write it")
{
    CHECK(spacing_in_words({2.0, 3.0, 5.0}, "um") == "2 x 3 x 5 \u00b5m");
    CHECK(spacing_in_words({0.8, 0.8, 1.25}, "mm") == "0.8 x 0.8 x 1.25 mm");
    CHECK(spacing_in_words({1.0, 1.0, 2.0}, "") == "1 x 1 x 2");
}

TEST_CASE("voxels are counted in 64 bits and hostile sizes are refused by name")
{
    CHECK(voxel_count(info_of_size({2048, 2048, 1024})) == int64_t{1} << 32);
    CHECK(voxel_count(info_of_size(Size3(int64_t{1} << 20))) == int64_t{1} << 60);
    for (const int64_t side : {int64_t{0}, int64_t{-5}, (int64_t{1} << 20) + 1, int64_t{1} << 31, int64_t{1} << 32,
                               std::numeric_limits<int64_t>::max(), std::numeric_limits<int64_t>::min()}) {
        CHECK(error_of([&] {
                  voxel_count(info_of_size({4, side, 4}));
              }) == sentence("a.raw: size along y is ", side, "; expected 1 to 1048576"));
    }
}

TEST_CASE("codes of integers are exact, and a threshold on codes is a threshold on intensities")
{
    struct Case {
        VoxelType type;
        int64_t minimum, maximum;
    };
    for (const auto& [type, minimum, maximum] :
         {Case{VoxelType::uint8, 0, 255}, Case{VoxelType::uint8, 7, 9}, Case{VoxelType::int8, -128, 127},
          Case{VoxelType::uint16, 0, 65535}, Case{VoxelType::uint16, 10, 300}, Case{VoxelType::uint16, 1, 32769},
          Case{VoxelType::int16, -32768, 32767}, Case{VoxelType::int16, -1024, 3033}, Case{VoxelType::int16, 5, 5},
          Case{VoxelType::uint32, 4294901760, 4294967295}, Case{VoxelType::uint32, 70000, 70255},
          Case{VoxelType::int32, -2147483648, -2147418113}, Case{VoxelType::int32, -300, 65235}}) {
        const IntensityWindow window = window_for(type, double(minimum), double(maximum));
        CAPTURE(name_of(type));
        CAPTURE(maximum);
        CHECK(window.codes_per_unit == std::floor(window.codes_per_unit));
        CHECK(window.codes_per_unit >= 1.0);
        CHECK(window.code_of(double(maximum)) <= 65535.0);
        CHECK(window.upper() >= double(maximum));
        const int64_t step = std::max<int64_t>(1, (maximum - minimum) / 50);
        for (double value = double(minimum); value <= double(maximum); value += double(step)) {
            CHECK(window.intensity_of(code(window, value)) == value);
            for (const double threshold : {value - 1.0, value - 0.5, value - 1e-6, value + 0.0, value + 1e-6,
                                           value + 0.3, std::nextafter(value, 1e10), std::nextafter(value, -1e10)}) {
                CHECK((code(window, value) >= window.threshold_code(threshold)) == (value >= threshold));
            }
        }
        CHECK(window.threshold_code(window.lower) == 0);
        CHECK(window.threshold_code(-1e300) == 0);
        CHECK(window.threshold_code(-std::numeric_limits<double>::infinity()) == 0);
        CHECK(window.threshold_code(std::nextafter(window.intensity_of(65535), 1e10)) == 65536);
        CHECK(window.threshold_code(std::numeric_limits<double>::infinity()) == 65536);
    }
    CHECK(window_for(VoxelType::uint8, 3, 4) == IntensityWindow{0.0, 257.0});
    CHECK(window_for(VoxelType::int8, 3, 4) == IntensityWindow{-128.0, 257.0});
    CHECK(window_for(VoxelType::uint16, 100, 355) == IntensityWindow{100.0, 257.0});
}

TEST_CASE("the window of floats spans what there is, also where that is one value")
{
    const IntensityWindow window = window_for(VoxelType::float32, -0.25, 0.75);
    CHECK(window.code_of(-0.25) == 0.0);
    CHECK(window.code_of(0.75) == 65535.0);
    CHECK(window.threshold_code(0.75) == 65535);
    CHECK(window.threshold_code(0.7500001) == 65536);
    for (const double value : {0.0, 3.5, -1e30, 1e-40}) {
        const IntensityWindow constant = window_for(VoxelType::float32, value, value);
        CHECK(constant.code_of(value) == 0.0);
        CHECK(constant.threshold_code(value) == 0);
        CHECK(constant.threshold_code(value + std::abs(value) + 2.0) == 65536);
    }
    const double largest = std::numeric_limits<float>::max();
    const IntensityWindow widest = window_for(VoxelType::float32, -largest, largest);
    CHECK(widest.code_of(largest) == doctest::Approx(65535.0));
    CHECK(widest.threshold_code(0.0) == 32768);
}

TEST_CASE("measuring agrees with counting by hand, for every type")
{
    const Size3 size(7, 5, 3);
    const auto check = [&]<class T>(VoxelType type, T first, T step) {
        std::vector<T> voxels(105);
        for (size_t i = 0; i < voxels.size(); ++i)
            voxels[i] = static_cast<T>(double(first) + double(i * 37 % 105) * double(step));
        const VolumeStatistics found = measure(memory_source(size, type, voxels));
        const double maximum = double(first) + 104.0 * double(step);
        CHECK(found.minimum == double(first));
        CHECK(found.maximum == maximum);
        CHECK(found.mean == doctest::Approx(0.5 * (double(first) + maximum)));
        CHECK(found.not_finite == 0);
        REQUIRE(found.histogram.size() == 256);
        CHECK(std::accumulate(found.histogram.begin(), found.histogram.end(), int64_t{0}) == 105);
        for (size_t i = 0; i < 105; ++i) CHECK(found.histogram[std::min<size_t>(255, i * 256 / 104)] == 1);
    };
    check(VoxelType::uint8, uint8_t{3}, uint8_t{2});
    check(VoxelType::int8, int8_t{-104}, int8_t{2});
    check(VoxelType::uint16, uint16_t{60}, uint16_t{600});
    check(VoxelType::int16, int16_t{-32768}, int16_t{512});
    check(VoxelType::uint32, uint32_t{4000000000}, uint32_t{2000000});
    check(VoxelType::int32, -2147483647 - 1, 40000000);
    check(VoxelType::float32, -3.5f, 0.25f);
    check(VoxelType::float64, -0x1p500, 0x1p494);
}

TEST_CASE("integers of 32 bits that reach farther than there are codes are quantised, like floats")
{
    const IntensityWindow wide = window_for(VoxelType::uint32, 0.0, 4294967295.0);
    CHECK(wide.code_of(4294967295.0) == doctest::Approx(65535.0));
    CHECK(wide.codes_per_unit < 1.0);
    CHECK(window_for(VoxelType::int32, -10.0, 65526.0).codes_per_unit < 1.0);
    CHECK(window_for(VoxelType::int32, -10.0, 65525.0).codes_per_unit == 1.0);
}

TEST_CASE("a window spans whatever doubles there are")
{
    const double most = std::numeric_limits<double>::max();
    const double least = std::numeric_limits<double>::denorm_min();
    for (const auto& [minimum, maximum] : {std::pair(-most, most), {0.0, most}, {0.0, least}, {-least, 1.0}}) {
        const IntensityWindow window = window_for(VoxelType::float64, minimum, maximum);
        CHECK(std::isfinite(window.lower));
        CHECK(std::isfinite(window.codes_per_unit));
        CHECK(window.codes_per_unit > 0.0);
        CHECK(std::isfinite(window.upper()));
        CHECK(window.threshold_code(minimum) == 0);
    }
    const VolumeStatistics widest =
        measure(memory_source<double>({3, 1, 1}, VoxelType::float64, {-most, 0.25 * most, most}));
    CHECK(widest.histogram[0] == 1);
    CHECK(widest.histogram[160] == 1);
    CHECK(widest.histogram[255] == 1);
}

TEST_CASE("one outlier of 1e30 takes neither precision nor the histogram from the other voxels")
{
    const Size3 size(64, 64, 64);
    std::vector<float> voxels(64 * 64 * 64);
    for (size_t i = 0; i < voxels.size(); ++i) voxels[i] = float(i % 4096) - 1024.0f;
    const VolumeStatistics plain = measure(memory_source(size, VoxelType::float32, voxels));
    CHECK_FALSE(plain.bulk.has_value());
    CHECK(plain.range() == ValueRange{-1024.0, 3071.0});
    CHECK(warnings_of(plain).empty());

    for (const float outlier : {1e30f, -1e30f, 25000.0f, std::numeric_limits<float>::max()}) {
        CAPTURE(outlier);
        std::vector<float> spoilt = voxels;
        spoilt[12345] = outlier;
        spoilt[12346] = std::numeric_limits<float>::quiet_NaN();
        const VolumeStatistics found = measure(memory_source(size, VoxelType::float32, spoilt));
        CHECK((outlier > 0.0f ? found.maximum : found.minimum) == outlier);
        CHECK(found.range() == ValueRange{-1024.0, 3071.0});
        CHECK(found.beyond_bulk == 1);
        CHECK(found.histogram[100] == 1024);
        CHECK(std::accumulate(found.histogram.begin(), found.histogram.end(), int64_t{0}) == 64 * 64 * 64 - 1);
        REQUIRE(warnings_of(found).size() == 2);
        CHECK(contains(warnings_of(found)[1], "1 voxel lies far outside -1024 to 3071, where all others are"));
    }
    // Less than four times as far as the others reach: it keeps a code of its own.
    voxels[0] = 15000.0f;
    const VolumeStatistics nearer = measure(memory_source(size, VoxelType::float32, voxels));
    CHECK(nearer.range().upper == 3071.0);
    CHECK(window_for(VoxelType::float32, nearer).upper() == doctest::Approx(15000.0).epsilon(1e-12));
    CHECK(contains(warnings_of(nearer).at(0), "counts neither for the histogram's range nor"));
}

TEST_CASE("what is rare but all there is to see is no outlier")
{
    std::vector<double> voxels(1000000, -5.0);
    voxels[500] = 1e6;
    voxels[501] = 3.0;
    const VolumeStatistics found = measure(memory_source({100, 100, 100}, VoxelType::float64, voxels));
    CHECK(found.range() == ValueRange{-5.0, 1e6});
    std::vector<int32_t> labels(1000000);
    for (size_t i = 0; i < labels.size(); ++i) labels[i] = int32_t(i % 7);
    labels[500] = 65000;  // all codes are exact: nothing is gained by leaving it out
    CHECK(measure(memory_source({100, 100, 100}, VoxelType::int32, labels)).range().upper == 65000.0);
    labels[500] = -2147483647;
    CHECK(measure(memory_source({100, 100, 100}, VoxelType::int32, labels)).range() == ValueRange{0.0, 6.0});
}

TEST_CASE("voxels that are no number are counted and left out")
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const VolumeStatistics some =
        measure(memory_source<float>({6, 1, 1}, VoxelType::float32, {nan, 1.0f, -infinity, 3.0f, infinity, 2.0f}));
    CHECK(some.minimum == 1.0);
    CHECK(some.maximum == 3.0);
    CHECK(some.mean == 2.0);
    CHECK(some.not_finite == 3);
    CHECK(some.histogram[0] + some.histogram[128] + some.histogram[255] == 3);

    const VolumeStatistics none = measure(memory_source<float>({2, 1, 1}, VoxelType::float32, {nan, infinity}));
    CHECK(none.minimum == 0.0);
    CHECK(none.maximum == 0.0);
    CHECK(none.not_finite == 2);
    CHECK(none.histogram == std::vector<int64_t>(256, 0));
}

TEST_CASE("a constant volume fills the first bin")
{
    const VolumeStatistics found = measure(memory_source<uint16_t>({3, 1, 1}, VoxelType::uint16, {9, 9, 9}));
    CHECK(found.minimum == 9.0);
    CHECK(found.maximum == 9.0);
    CHECK(found.histogram[0] == 3);
}

TEST_CASE("measuring reads at most 16 MiB at a time, also where one slice is larger")
{
    class Wide : public VolumeSource {
    public:
        Wide() : VolumeSource(wide_info()) {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override
        {
            largest = std::max(largest, voxels.size());
            total += voxels.size();
            CHECK(box.size().x * box.size().y * box.size().z == int64_t(voxels.size()));
            std::memset(voxels.data(), 1, voxels.size());
        }
        static VolumeInfo wide_info()
        {
            VolumeInfo info;
            info.size = {int64_t{1} << 20, 40, 2};
            return info;
        }
        mutable size_t largest = 0, total = 0;
    };
    const Wide wide;
    CHECK(measure(wide).mean == 1.0);
    CHECK(wide.largest <= size_t{16} << 20);
    CHECK(wide.total == size_t{80} << 20);
}

TEST_CASE("one thread at a time reads a volume that is measured, also where parts cannot be read")
{
    class Broken : public VolumeSource {
    public:
        Broken() : VolumeSource(info_of()) {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override
        {
            if (users.fetch_add(1) > 0) overlaps = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            std::memset(voxels.data(), 3, voxels.size());
            users.fetch_sub(1);
            if (box.lower.z <= 2 && box.upper.z > 2) fail("slice 2 is gone");
        }
        static VolumeInfo info_of()
        {
            VolumeInfo info;
            info.size = {4096, 1024, 16};
            return info;
        }
        mutable std::atomic<int> users = 0;
        mutable std::atomic<bool> overlaps = false;
    };
    const Broken broken;
    Gaps gaps;
    CHECK(measure(broken, {.gaps = &gaps}).mean == 3.0);
    CHECK(gaps.voxels() == 4096 * 1024);
    CHECK_FALSE(broken.overlaps);
    CHECK(error_of([&] { measure(broken); }) == "slice 2 is gone");
}

TEST_CASE("of a volume too large to go through, a coarser level is measured and said")
{
    /// Level 0 is all 7, level 1 all 9, so that statistics show which level was measured.
    class Levels : public VolumeSource {
    public:
        explicit Levels(int64_t side) : VolumeSource(info_of(side)) {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
        int levels() const override { return 2; }
        void read_level(int level, const VoxelBox&, std::span<std::byte> voxels) const override
        {
            const auto value = uint16_t(level == 0 ? 7 : 9);
            for (size_t i = 0; i < voxels.size(); i += 2) std::memcpy(&voxels[i], &value, 2);
        }
        static VolumeInfo info_of(int64_t side)
        {
            VolumeInfo info;
            info.size = {side, side, 2};
            info.type = VoxelType::uint16;
            return info;
        }
    };
    const VolumeStatistics fits = measure(Levels(int64_t{1} << 8));
    CHECK(fits.measured_level == 0);
    CHECK(fits.mean == 7.0);
    CHECK(window_for(VoxelType::uint16, fits).lower == 7.0);

    static_assert(2 * ((int64_t{1} << 13) + 2) * ((int64_t{1} << 13) + 2) > MAX_VOXELS_MEASURED);
    const VolumeStatistics large = measure(Levels((int64_t{1} << 13) + 2));
    CHECK(large.measured_level == 1);
    CHECK(large.mean == 9.0);
    REQUIRE(warnings_of(large).size() == 1);
    CHECK(contains(warnings_of(large)[0], "measured on level 1, whose voxels are means of 8"));
    // Single voxels may have any value of the type.
    const IntensityWindow window = window_for(VoxelType::uint16, large);
    CHECK(window.lower == 0.0);
    CHECK(window.upper() == 65535.0);
}

namespace {

/// 1100 x 1000 x 1000 voxels of 16 bits: x, but 60000 in one voxel that no sample meets.
class Plain : public VolumeSource {
public:
    Plain() : VolumeSource(plain_info()) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        auto* to = reinterpret_cast<uint16_t*>(voxels.data());
        boxes.push_back(box);
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x)
                    *to++ = Size3(x, y, z) == Size3(1099, 999, 999) ? uint16_t{60000} : uint16_t(x);
    }
    static VolumeInfo plain_info()
    {
        VolumeInfo info;
        info.size = {1100, 1000, 1000};
        info.type = VoxelType::uint16;
        return info;
    }
    mutable std::vector<VoxelBox> boxes;
};

}  // namespace

TEST_CASE("a huge volume without levels is estimated from a sample that is spread evenly, and said; exactly on demand")
{
    const Plain plain;
    const VolumeStatistics sample = measure(plain);
    CHECK(sample.sampled_voxels == 256 * 238 * 1100);  // 256 pieces of as many whole rows as 2^18 voxels have
    CHECK(sample.minimum == 0.0);
    CHECK(sample.maximum == 1099.0);
    CHECK(sample.mean == doctest::Approx(549.5));
    CHECK(sample.measured_level == 0);
    std::vector<int64_t> slices, rows;
    for (const VoxelBox& box : plain.boxes) {
        slices.push_back(box.lower.z);
        rows.push_back(box.lower.y);
    }
    CHECK(std::ranges::is_sorted(slices));  // forwards through the file
    for (size_t i = 1; i < slices.size(); ++i) CHECK(slices[i] - slices[i - 1] <= 4);
    std::ranges::sort(rows);
    CHECK(rows.front() <= 5);
    CHECK(rows.back() >= 755);
    for (size_t i = 1; i < rows.size(); ++i) CHECK(rows[i] - rows[i - 1] <= 12);
    REQUIRE(warnings_of(sample).size() == 1);
    CHECK(contains(warnings_of(sample)[0],
                   "estimated from a sample of 67020800 voxels; others may lie beyond 0 to 1099: "
                   "`shvr info --exact` goes through all, and so does `shvr import`"));
    CHECK(window_for(VoxelType::uint16, sample).upper() == 65535.0);

    double told = 0.0;
    const VolumeStatistics exact = measure(plain, {.exact = true, .progress = [&](double fraction) {
                                                       CHECK(fraction >= told);
                                                       told = fraction;
                                                   }});
    CHECK(told == 1.0);
    CHECK(exact.maximum == 60000.0);
    CHECK(exact.sampled_voxels == 0);
    REQUIRE(warnings_of(exact).size() == 1);
    CHECK(contains(warnings_of(exact)[0], "1 voxel lies far outside 0 to 1099"));
}

TEST_CASE("what progress throws ends measuring")
{
    CHECK(error_of([] {
              measure(memory_source<uint16_t>({3, 1, 1}, VoxelType::uint16, {9, 9, 9}),
                      {.progress = [](double) { throw Stopped("stopped"); }});
          }) == "stopped");
}
