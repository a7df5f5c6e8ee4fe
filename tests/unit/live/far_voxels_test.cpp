#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"
#include "engine/live/far_voxels.h"

using namespace shvr;

namespace {

/// A volume on a machine that answers once `answers` is set; its voxels are their x.
class Far : public VolumeSource {
public:
    Far() : VolumeSource({.name = "far", .size = {64, 4, 4}}) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        ++reads;
        while (!answers) {
            stop_if_wait_is_over();
            std::this_thread::yield();
        }
        if (box.lower.x == 13) fail("far: is torn");
        for (size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::byte(box.lower.x + int64_t(i));
    }
    mutable std::atomic<int> reads = 0;
    std::atomic<bool> answers = false;
};

VoxelBox at(int64_t x)
{
    return {{x, 1, 1}, {x + 2, 2, 2}};
}

void wait_for(const std::function<bool()>& holds)
{
    while (!holds()) std::this_thread::yield();
}

}  // namespace

TEST_CASE("far voxels: a box is there once its machine has answered, and nobody waits for that")
{
    const auto source = std::make_shared<Far>();
    FarVoxels far;
    CHECK_FALSE(far.is_reading());
    CHECK_FALSE(far.find(source, at(5)));
    CHECK_FALSE(far.find(source, at(5)));
    CHECK(far.is_reading());
    source->answers = true;
    wait_for([&] { return !far.is_reading(); });
    CHECK(far.find(source, at(5))->values == std::vector{5.0, 6.0});
    CHECK(source->reads == 1);
}

TEST_CASE("far voxels: another box ends the wait for the first, and so does the end")
{
    const auto source = std::make_shared<Far>();
    FarVoxels far;
    far.find(source, at(5));
    wait_for([&] { return source->reads == 1; });
    far.find(source, at(7));
    wait_for([&] { return source->reads == 2; });
    source->answers = true;
    wait_for([&] { return far.find(source, at(7)).has_value(); });
    CHECK(far.find(source, at(7))->values == std::vector{7.0, 8.0});
    source->answers = false;
    far.find(source, at(9));
    wait_for([&] { return source->reads == 3; });
}

TEST_CASE("far voxels: a box that cannot be read has no values, and is not read again and again")
{
    const auto source = std::make_shared<Far>();
    source->answers = true;
    FarVoxels far;
    far.find(source, at(13));
    wait_for([&] { return !far.is_reading(); });
    CHECK_FALSE(far.find(source, at(13)));
    CHECK_FALSE(far.is_reading());
    CHECK(source->reads == 1);
}
