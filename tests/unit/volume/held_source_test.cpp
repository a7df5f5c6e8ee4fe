#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"
#include "engine/volume/held_source.h"

using namespace shvr;

namespace {

/// A volume on a machine that answers once `answers` is set; its voxels are their x. Voxels from x = 50 on are torn.
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
        if (box.lower.x >= 50) fail("far: is torn");
        for (size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::byte(box.lower.x + int64_t(i));
    }
    mutable std::atomic<int> reads = 0;
    std::atomic<bool> answers = false;
};

HeldSource::Part at(int64_t x)
{
    return {.level = 0, .box = {{x, 1, 1}, {x + 2, 2, 2}}};
}

std::vector<std::byte> read(const HeldSource& source, int64_t x)
{
    std::vector<std::byte> voxels(2);
    source.read(at(x).box, voxels);
    return voxels;
}

void wait_for(const std::function<bool()>& holds)
{
    while (!holds()) std::this_thread::yield();
}

}  // namespace

TEST_CASE("held boxes: all are read at once in the background, and then again without their machine")
{
    const auto far = std::make_shared<Far>();
    HeldSource source(far);
    const std::vector parts{at(5), at(9), at(55)};
    CHECK_FALSE(source.hold(parts));
    wait_for([&] { return far->reads == 3; });
    CHECK_FALSE(source.hold(parts));
    far->answers = true;
    wait_for([&] { return source.hold(parts); });
    CHECK(read(source, 9) == std::vector{std::byte{9}, std::byte{10}});
    CHECK(read(source, 5) == std::vector{std::byte{5}, std::byte{6}});
    CHECK_THROWS_WITH_AS(read(source, 55), "far: is torn", Error);
    CHECK(far->reads == 3);
    CHECK(read(source, 20) == std::vector{std::byte{20}, std::byte{21}});
    CHECK(far->reads == 4);
}

TEST_CASE("held boxes: what is no longer wanted is not waited for, and what is still wanted is not read again")
{
    const auto far = std::make_shared<Far>();
    HeldSource source(far);
    CHECK(source.hold({}));
    far->answers = true;
    wait_for([&] { return source.hold(std::vector{at(5)}); });
    far->answers = false;
    CHECK_FALSE(source.hold(std::vector{at(5), at(7)}));
    wait_for([&] { return far->reads == 2; });
    CHECK(source.hold(std::vector{at(5)}));
    CHECK_FALSE(source.hold(std::vector{at(5), at(9)}));
    wait_for([&] { return far->reads == 3; });
    source.release();
    CHECK_FALSE(source.hold(std::vector{at(11)}));
    wait_for([&] { return far->reads == 4; });
}
