// Bits of bricks against the voxels themselves: boxes at any place, ends of the volume, changes, failures.

#include "engine/bricks/threshold_bricks.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "engine/volume/offset_source.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const Size3 SIZE(70, 45, 40);

std::vector<float> noise()
{
    std::mt19937 random(3);
    std::vector<float> voxels(size_t(SIZE.x * SIZE.y * SIZE.z));
    for (float& voxel : voxels) voxel = float(random() % 100000) * 0.001f;
    voxels[5] = std::numeric_limits<float>::quiet_NaN();
    return voxels;
}

/// Reads of it are counted, and fail or wait from z = 32 on if they should.
class CountedSource final : public VolumeSource {
public:
    explicit CountedSource(const std::vector<float>& voxels)
        : VolumeSource(memory_source(SIZE, VoxelType::float32, voxels).info()),
          source_(memory_source(SIZE, VoxelType::float32, voxels))
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        ++reads;
        if (fails && box.upper.z > 32) fail("no such slice");
        while (is_silent && box.upper.z > 32) std::this_thread::yield();
        source_.read(box, voxels);
    }
    mutable std::atomic<int> reads = 0;
    bool fails = false;
    std::atomic<bool> is_silent = false;

private:
    MemorySource source_;
};

/// The number of bits that differ from the voxels, and of those that are set outside the box.
int64_t wrong_bits(const std::vector<uint32_t>& bits, const VoxelBox& box, const std::vector<float>& voxels,
                   double threshold)
{
    const Size3 size = box.size();
    const int64_t words = (size.x + 31) / 32;
    REQUIRE(bits.size() == size_t(words * size.y * size.z));
    int64_t wrong = 0;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < 32 * words; ++x) {
                const bool is_set = (bits[size_t(words * (y + size.y * z) + x / 32)] >> (x % 32) & 1u) != 0;
                const Size3 voxel = box.lower + Size3(x, y, z);
                const bool expected =
                    x < size.x && double(voxels[size_t(voxel.x + SIZE.x * (voxel.y + SIZE.y * voxel.z))]) >= threshold;
                wrong += is_set != expected;
            }
    return wrong;
}

bool becomes_ready(ThresholdBricks& bricks, const VoxelBox& box, double threshold)
{
    for (int tries = 0; tries < 100000; ++tries) {
        if (bricks.get_ready(box, threshold)) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

}  // namespace

TEST_CASE("bits are those of the voxels in any box, for several thresholds")
{
    const std::vector<float> voxels = noise();
    ThresholdBricks bricks(std::make_shared<CountedSource>(voxels));
    for (const VoxelBox& box :
         {VoxelBox{Size3(0), SIZE}, VoxelBox{{31, 31, 31}, {33, 33, 33}}, VoxelBox{{1, 2, 3}, {70, 4, 40}},
          VoxelBox{{69, 44, 39}, {70, 45, 40}}, VoxelBox{{5, 0, 0}, {37, 1, 1}}, VoxelBox{{30, 7, 8}, {64, 45, 9}}})
        for (const double threshold : {-1.0, 50.0, double(voxels[777]), std::nextafter(double(voxels[777]), 1e9), 1e9})
            CHECK(wrong_bits(bricks.bits_in(box, threshold), box, voxels, threshold) == 0);
}

TEST_CASE("bricks are read once, in the background if asked for, and again after a change")
{
    const std::vector<float> voxels = noise();
    const auto counted = std::make_shared<CountedSource>(voxels);
    const auto source = std::make_shared<OffsetSource>(counted);
    ThresholdBricks bricks(source);
    const VoxelBox box{{10, 10, 10}, {60, 40, 30}};
    REQUIRE(becomes_ready(bricks, box, 50.0));
    const int reads = counted->reads;
    CHECK(wrong_bits(bricks.bits_in(box, 50.0), box, voxels, 50.0) == 0);
    CHECK(counted->reads == reads);

    auto offsets = std::make_shared<OffsetBrick>();
    offsets->fill(offset_bits(VoxelType::float32, 1000.0));
    const OffsetSource::Brick raised{{1, 0, 0}, offsets};
    source->set(std::span(&raised, 1));
    const VoxelBox changed{{32, 0, 0}, {64, 32, 32}};
    bricks.renew(std::span(&changed, 1));
    CHECK_FALSE(bricks.get_ready(box, 50.0));
    REQUIRE(becomes_ready(bricks, box, 50.0));
    std::vector<float> expected = voxels;
    for (int64_t z = 0; z < 32; ++z)
        for (int64_t y = 0; y < 32; ++y)
            for (int64_t x = 32; x < 64; ++x) expected[size_t(x + SIZE.x * (y + SIZE.y * z))] += 1000.0f;
    CHECK(wrong_bits(bricks.bits_in(box, 50.0), box, expected, 50.0) == 0);
}

TEST_CASE("voxels that cannot be read are told of, and others are not affected")
{
    const std::vector<float> voxels = noise();
    const auto counted = std::make_shared<CountedSource>(voxels);
    counted->fails = true;
    ThresholdBricks bricks(counted);
    const VoxelBox broken{{0, 0, 0}, {40, 40, 40}}, whole{{0, 0, 0}, {40, 40, 32}};
    CHECK_THROWS_WITH_AS(bricks.bits_in(broken, 50.0), "no such slice", Error);
    CHECK_THROWS_AS(becomes_ready(bricks, broken, 50.0), Error);
    CHECK(wrong_bits(bricks.bits_in(whole, 50.0), whole, voxels, 50.0) == 0);
    counted->fails = false;
    CHECK(wrong_bits(bricks.bits_in(broken, 50.0), broken, voxels, 50.0) == 0);
}

TEST_CASE("bits that are there are returned while others are still being read")
{
    const std::vector<float> voxels = noise();
    const auto source = std::make_shared<CountedSource>(voxels);
    ThresholdBricks bricks(source);
    const VoxelBox there{{3, 4, 5}, {40, 30, 30}}, far{{3, 4, 33}, {40, 30, 40}};
    while (!bricks.get_ready(there, 50.0)) std::this_thread::yield();
    source->is_silent = true;
    CHECK_FALSE(bricks.get_ready(far, 50.0));
    CHECK(bricks.get_ready(there, 50.0));
    CHECK(wrong_bits(bricks.bits_in(there, 50.0), there, voxels, 50.0) == 0);
    source->is_silent = false;
    while (!bricks.get_ready(far, 50.0)) std::this_thread::yield();
    CHECK(wrong_bits(bricks.bits_in(far, 50.0), far, voxels, 50.0) == 0);
}
