#include "engine/bricks/brick_builder.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <random>

#include <doctest/doctest.h>

#include "engine/bricks/code_rows.h"
#include "engine/volume/procedural/source_procedural.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr int64_t TEXELS = gpu::BRICK_TEXELS;
constexpr int64_t CELLS = gpu::BRICK_CELLS;

template <class T>
std::vector<T> random_voxels(const Size3& size, uint32_t seed)
{
    std::mt19937 random(seed);
    std::vector<T> voxels(size_t(size.x * size.y * size.z));
    for (T& voxel : voxels) {
        if constexpr (std::is_floating_point_v<T>) {
            voxel = random() % 20 == 0 ? std::numeric_limits<T>::quiet_NaN() : static_cast<T>(random() % 1000) / T{7};
        } else {
            voxel = static_cast<T>(random());
        }
    }
    return voxels;
}

uint16_t expected_code(double voxel, const IntensityWindow& window)
{
    if (std::isnan(voxel)) return 0;
    return uint16_t(std::clamp(std::floor(window.code_of(voxel) + 0.5), 0.0, 65535.0));
}

/// Builds with `threads` and compares every brick with one built voxel by voxel.
template <class T>
void check_against_brute_force(const Size3& size, VoxelType type, int threads)
{
    const std::vector<T> voxels = random_voxels<T>(size, 7);  // seed 7
    const MemorySource source = memory_source(size, type, voxels);
    const VolumeStatistics statistics = measure(source);
    const IntensityWindow window = window_for(type, statistics.minimum, statistics.maximum);
    const glm::ivec3 counts = brick_counts(size);
    int64_t index = 0;
    size_t wrong_codes = 0;
    size_t wrong_ranges = 0;
    build_bricks(source, window, threads, [&](const glm::ivec3& brick, const BrickTexels& texels) {
        CHECK(brick.x + counts.x * (brick.y + counts.y * brick.z) == index++);
        const auto code_at = [&](const Size3& texel) {
            const Size3 voxel =
                glm::clamp(Size3(brick) * int64_t{gpu::BRICK_SIZE} + texel - int64_t{1}, Size3(0), size - int64_t{1});
            return expected_code(voxels[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))], window);
        };
        const auto range_of = [&](const Size3& lower, const Size3& upper) {
            BrickTexels::Range range{65535, 0};
            for (int64_t z = lower.z; z < upper.z; ++z) {
                for (int64_t y = lower.y; y < upper.y; ++y) {
                    for (int64_t x = lower.x; x < upper.x; ++x) {
                        const uint16_t code = texels.codes[size_t(x + TEXELS * (y + TEXELS * z))];
                        range.minimum = std::min(range.minimum, code);
                        range.maximum = std::max(range.maximum, code);
                    }
                }
            }
            return range;
        };
        size_t at = 0;
        for (int64_t z = 0; z < TEXELS; ++z) {
            for (int64_t y = 0; y < TEXELS; ++y) {
                for (int64_t x = 0; x < TEXELS; ++x) wrong_codes += texels.codes[at++] != code_at({x, y, z});
            }
        }
        for (int64_t cell = 0; cell < CELLS * CELLS * CELLS; ++cell) {
            const Size3 lower =
                Size3(cell % CELLS, cell / CELLS % CELLS, cell / (CELLS * CELLS)) * int64_t{gpu::CELL_SIZE};
            wrong_ranges += texels.cell_ranges[size_t(cell)] != range_of(lower, lower + int64_t{6});
        }
        wrong_ranges += texels.range != range_of(Size3(0), Size3(TEXELS));
    });
    CHECK(index == int64_t{counts.x} * counts.y * counts.z);
    CHECK(wrong_codes == 0);
    CHECK(wrong_ranges == 0);
}

/// A volume that counts how often each slice is read.
class CountingSource : public VolumeSource {
public:
    explicit CountingSource(const Size3& size, int64_t broken_slice = -1)
        : VolumeSource(info_of(size)), reads(size_t(size.z)), broken_slice_(broken_slice)
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const std::lock_guard lock(mutex_);
        if (box.lower.z <= broken_slice_ && broken_slice_ < box.upper.z) fail("slice ", broken_slice_, " is broken");
        largest_read = std::max(largest_read, voxels.size());
        const size_t slice_bytes = size_t(info().size.x * info().size.y);
        for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
            ++reads[size_t(z)];
            std::memset(voxels.data() + size_t(z - box.lower.z) * slice_bytes, int(z % 256), slice_bytes);
            farthest_slice = std::max(farthest_slice, z);
        }
    }
    int64_t farthest() const
    {
        const std::lock_guard lock(mutex_);
        return farthest_slice;
    }

    static VolumeInfo info_of(const Size3& size)
    {
        VolumeInfo info;
        info.size = size;
        return info;
    }

    mutable std::vector<int> reads;
    mutable size_t largest_read = 0;
    mutable int64_t farthest_slice = -1;

private:
    mutable std::mutex mutex_;
    int64_t broken_slice_;
};

}  // namespace

TEST_CASE("a volume is covered by as many bricks as it takes")
{
    CHECK(brick_counts({1, 32, 33}) == glm::ivec3(1, 1, 2));
    CHECK(brick_counts({2048, 2047, int64_t{1} << 20}) == glm::ivec3(64, 64, 32768));
}

TEST_CASE("bricks and their ranges equal those made voxel by voxel")
{
    for (const Size3& size : {Size3(1), Size3(2), Size3(33), Size3(100, 7, 65), Size3(32, 64, 32), Size3(5, 31, 97)}) {
        CAPTURE(size.x);
        check_against_brute_force<uint8_t>(size, VoxelType::uint8, 1);
        check_against_brute_force<int16_t>(size, VoxelType::int16, 3);
    }
    check_against_brute_force<int8_t>({100, 7, 65}, VoxelType::int8, 2);
    check_against_brute_force<uint16_t>({100, 7, 65}, VoxelType::uint16, 2);
    check_against_brute_force<uint32_t>({100, 7, 65}, VoxelType::uint32, 2);
    check_against_brute_force<int32_t>({100, 7, 65}, VoxelType::int32, 2);
    check_against_brute_force<float>({100, 7, 65}, VoxelType::float32, 2);
    check_against_brute_force<double>({100, 7, 65}, VoxelType::float64, 2);
    check_against_brute_force<uint8_t>({32 * 66 + 1, 2, 3}, VoxelType::uint8, 2);  // more than one run along x
}

TEST_CASE("more threads change nothing")
{
    const auto source = open_procedural({.kind = "tubes", .size = {70, 50, 130}});
    const auto build = [&](int threads) {
        std::vector<uint16_t> codes;
        build_bricks(*source, window_for(VoxelType::uint8, 0, 255), threads,
                     [&](const glm::ivec3&, const BrickTexels& brick) {
                         codes.insert(codes.end(), brick.codes.begin(), brick.codes.end());
                     });
        return codes;
    };
    const std::vector<uint16_t> one = build(1);
    for (const int threads : {0, 2, 7}) CHECK(build(threads) == one);
}

TEST_CASE("codes are the rounded map of the window, clamped to it")
{
    const auto check = [&]<class T>(VoxelType type, T least, T most) {
        std::vector<T> voxels;
        for (int i = 0; i <= 500; ++i) {
            voxels.push_back(static_cast<T>(double(least) + (double(most) - double(least)) * i / 500.0));
        }
        for (const IntensityWindow& window :
             {IntensityWindow{0.0, 257.0}, IntensityWindow{-128.0, 257.0}, IntensityWindow{10.0, 3.0},
              IntensityWindow{10.5, 3.0}, IntensityWindow{-5.0, 0.25}, IntensityWindow{-32768.0, 1.0},
              IntensityWindow{30000.0, 65535.0}, IntensityWindow{40000.0, 9.0}, IntensityWindow{-32768.0, 60000.0},
              IntensityWindow{1e6, 2.0}, IntensityWindow{-2147483648.0, 1.0}, IntensityWindow{4294901760.0, 1.0},
              IntensityWindow{4e9, 7.0}}) {
            std::vector<uint16_t> codes(voxels.size());
            CodeRows(type, window).convert(std::as_bytes(std::span(voxels)), codes);
            size_t wrong = 0;
            for (size_t i = 0; i < codes.size(); ++i) {
                // The exact path clamps to the last intensity with its own code.
                const double whole_upper = window.lower + std::floor(65535.0 / window.codes_per_unit);
                const uint16_t clamped = expected_code(voxels[i], window);
                wrong +=
                    codes[i] != clamped && !(voxels[i] > whole_upper && codes[i] == expected_code(whole_upper, window));
            }
            CAPTURE(name_of(type));
            CAPTURE(window.lower);
            CHECK(wrong == 0);
        }
    };
    check(VoxelType::uint8, uint8_t{0}, uint8_t{255});
    check(VoxelType::int8, int8_t{-128}, int8_t{127});
    check(VoxelType::uint16, uint16_t{0}, uint16_t{65535});
    check(VoxelType::int16, int16_t{-32768}, int16_t{32767});
    check(VoxelType::uint32, uint32_t{0}, std::numeric_limits<uint32_t>::max());
    check(VoxelType::uint32, uint32_t{4294900000}, std::numeric_limits<uint32_t>::max());
    check(VoxelType::int32, std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max());
    check(VoxelType::int32, -40000, 70000);
    check(VoxelType::float32, -40000.0f, 70000.0f);
    check(VoxelType::float64, -40000.0, 70000.0);

    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> odd = {std::numeric_limits<float>::quiet_NaN(), -infinity, infinity, 0.5f, -0.0f};
    std::vector<uint16_t> codes(odd.size());
    CodeRows(VoxelType::float32, {0.0, 65535.0}).convert(std::as_bytes(std::span(odd)), codes);
    CHECK(codes == std::vector<uint16_t>{0, 0, 65535, 32768, 0});
}

TEST_CASE("every slice is read once, a few at a time and not far ahead")
{
    for (const int threads : {1, 3}) {
        const CountingSource source({40, 33, 400});
        build_bricks(source, {0.0, 257.0}, threads, [&](const glm::ivec3& brick, const BrickTexels& texels) {
            // At most the slab after those with rows waiting to be taken: threads + 2 rows, two per slab.
            CHECK(source.farthest() <= (brick.z + (threads + 2) / 2 + 2) * 32 + 32);
            CHECK(texels.codes[size_t(TEXELS * TEXELS)] == 257 * (brick.z * 32 % 256));
        });
        CHECK(source.reads == std::vector<int>(400, 1));
        CHECK(source.largest_read <= 40 * 33 * 34);
    }
}

TEST_CASE("what goes wrong in a worker or in the taker ends the building")
{
    for (const int threads : {1, 4}) {
        for (const int64_t slice : {0, 70, 199}) {
            const CountingSource source({64, 64, 200}, slice);
            CHECK(error_of([&] {
                      build_bricks(source, {0.0, 257.0}, threads, [](const glm::ivec3&, const BrickTexels&) {});
                  }) == sentence("slice ", slice, " is broken"));
        }
        const CountingSource source({64, 64, 200});
        int taken = 0;
        CHECK(error_of([&] {
                  build_bricks(source, {0.0, 257.0}, threads, [&](const glm::ivec3&, const BrickTexels&) {
                      if (++taken == 3) fail("no room");
                  });
              }) == "no room");
        CHECK(taken == 3);
    }
}
