#include <doctest/doctest.h>
#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <random>
#include <semaphore>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"
#include "engine/bricks/brick_store.h"
#include "shaders/bricks.h"
#include "tests/support/volume_files.h"

using namespace shvr;

namespace {

constexpr int64_t SIDE = int64_t{gpu::BRICK_SIZE};

/// A row of bricks whose voxels are their brick's number; records when each brick is read, and can be made to wait.
class Row : public VolumeSource {
public:
    explicit Row(int64_t bricks) : VolumeSource(info_of(bricks)) {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const auto brick = int((box.lower.x + box.upper.x) / 2 / SIDE);
        if (waits) gate.acquire();
        {
            const std::scoped_lock lock(mutex_);
            order_.push_back(brick);
        }
        if (brick == broken) fail("row.raw: brick ", brick, " is torn");
        std::ranges::fill(voxels, std::byte(brick));
    }
    std::vector<int> order() const
    {
        const std::scoped_lock lock(mutex_);
        return order_;
    }
    void wait_for_reads(size_t count) const
    {
        while (order().size() < count) std::this_thread::yield();
    }

    std::atomic<bool> waits = false;
    mutable std::counting_semaphore<> gate{0};
    int broken = -1;

private:
    static VolumeInfo info_of(int64_t bricks)
    {
        VolumeInfo info;
        info.name = "row";
        info.size = {bricks * SIDE, SIDE, SIDE};
        return info;
    }
    mutable std::mutex mutex_;
    mutable std::vector<int> order_;
};

BrickKey key_of(int brick)
{
    return {0, {brick, 0, 0}};
}

std::vector<BrickKey> keys_of(std::initializer_list<int> bricks)
{
    std::vector<BrickKey> keys;
    for (const int brick : bricks) keys.push_back(key_of(brick));
    return keys;
}

uint16_t middle_of(const BrickTexels& texels)
{
    const size_t side = gpu::BRICK_TEXELS, half = side / 2;
    return texels.codes[half + side * (half + side * half)];
}

/// Takes all wanted bricks; returns them in order of arrival.
std::vector<int> take_all(BrickStore& store)
{
    std::vector<int> taken;
    while (store.wait())
        for (const BrickStore::Finished& finished : store.take(100)) {
            taken.push_back(finished.key.brick.x);
            if (finished.texels) CHECK(middle_of(*finished.texels) == 257 * finished.key.brick.x);
        }
    return taken;
}

constexpr uint64_t BRICK_BYTES = sizeof(BrickTexels);
const IntensityWindow WINDOW{0.0, 257.0};

}  // namespace

TEST_CASE("bricks are loaded in the order in which they are wanted, each once")
{
    const Row row(8);
    BrickStore store(row, WINDOW, 8 * BRICK_BYTES, 1);
    store.want(keys_of({5, 2, 7, 0}));
    CHECK((take_all(store) == std::vector{5, 2, 7, 0}));
    CHECK((row.order() == std::vector{5, 2, 7, 0}));
    store.want(keys_of({2, 3}));
    CHECK((take_all(store) == std::vector{2, 3}));
    CHECK((row.order() == std::vector{5, 2, 7, 0, 3}));
    CHECK(store.counts().loads == 5);
    CHECK(store.counts().hits == 1);
    CHECK(store.counts().dropped == 0);
    CHECK_FALSE(store.wait());
}

TEST_CASE("what is no longer wanted is not begun")
{
    Row row(8);
    row.waits = true;
    BrickStore store(row, WINDOW, 8 * BRICK_BYTES, 1);
    store.want(keys_of({1, 2, 3, 4}));
    row.gate.release();  // brick 1 is read; 2 may have been started
    row.wait_for_reads(1);
    store.want(keys_of({6}));
    row.waits = false;
    row.gate.release(8);
    CHECK((take_all(store) == std::vector{6}));
    const std::vector<int> order = row.order();
    CHECK(order.size() <= 3);
    CHECK(std::ranges::find(order, 3) == order.end());
    CHECK(std::ranges::find(order, 4) == order.end());
    CHECK(store.counts().dropped >= 2);
}

TEST_CASE("bricks of a source that has changed are read again, kept ones and those in the loaders' hands")
{
    Row row(8);
    BrickStore store(row, WINDOW, 8 * BRICK_BYTES, 1);
    store.want(keys_of({1, 2}));
    CHECK((take_all(store) == std::vector{1, 2}));
    store.renew(keys_of({2, 5}));
    CHECK(store.bytes() == BRICK_BYTES);
    store.want(keys_of({1, 2}));
    CHECK((take_all(store) == std::vector{1, 2}));
    CHECK((row.order() == std::vector{1, 2, 2}));

    // A brick that is being read, from the old data.
    row.waits = true;
    store.want(keys_of({4}));
    while (store.bytes() < 3 * BRICK_BYTES) std::this_thread::yield();
    store.renew(keys_of({4}));
    row.gate.release(2);
    CHECK((take_all(store) == std::vector{4}));
    CHECK((row.order() == std::vector{1, 2, 2, 4, 4}));
    row.waits = false;

    // A brick that is ready but not taken is handed out once, with the new data.
    store.want(keys_of({6}));
    REQUIRE(store.wait());
    store.renew(keys_of({6}));
    CHECK((take_all(store) == std::vector{6}));
    CHECK((row.order() == std::vector{1, 2, 2, 4, 4, 6, 6}));
    CHECK_FALSE(store.wait());
}

TEST_CASE("bricks on the host keep within the budget; those used longest ago go first")
{
    const Row row(16);
    BrickStore store(row, WINDOW, 4 * BRICK_BYTES, 1);
    store.want(keys_of({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
    CHECK(take_all(store).size() == 10);
    CHECK(store.bytes() <= 4 * BRICK_BYTES);
    CHECK(store.peak_bytes() <= 4 * BRICK_BYTES);
    CHECK(store.get(key_of(9)) != nullptr);
    CHECK(store.counts().loads == 10);  // it was still kept
    CHECK(store.get(key_of(0)) != nullptr);
    CHECK(store.counts().loads == 11);
    CHECK(store.peak_bytes() <= 4 * BRICK_BYTES);
}

TEST_CASE("a brick that cannot be read is named once, handed out as missing and never tried again")
{
    Row row(4);
    row.broken = 2;
    BrickStore store(row, WINDOW, 4 * BRICK_BYTES, 1);
    store.want(keys_of({1, 2, 3}));
    size_t missing = 0;
    while (store.wait())
        for (const BrickStore::Finished& finished : store.take(100)) missing += finished.texels == nullptr;
    CHECK(missing == 1);
    CHECK((store.take_messages() == std::vector<std::string>{"row.raw: brick 2 is torn"}));
    store.want(keys_of({2}));
    CHECK((take_all(store) == std::vector{2}));
    CHECK(store.get(key_of(2)) == nullptr);
    CHECK(store.take_messages().empty());
    CHECK(std::ranges::count(row.order(), 2) == 1);
    CHECK(store.failure_of(key_of(2)) == "row.raw: brick 2 is torn");
    CHECK_FALSE(store.failure_of(key_of(1)));
}

TEST_CASE("many loaders, and an owner who keeps changing their mind: what comes is what was wanted last")
{
    const Row row(24);
    BrickStore store(row, WINDOW, 6 * BRICK_BYTES, 3);
    std::mt19937 random(7);
    for (int round = 0; round < 200; ++round) {
        std::vector<int> bricks(24);
        std::iota(bricks.begin(), bricks.end(), 0);
        std::ranges::shuffle(bricks, random);
        bricks.resize(1 + random() % 12);
        std::vector<BrickKey> keys;
        for (const int brick : bricks) keys.push_back(key_of(brick));
        store.want(keys);
        if (random() % 3 == 0) CHECK(middle_of(*store.get(key_of(bricks[0]))) == 257 * bricks[0]);
        if (random() % 2 == 0) continue;  // never taken
        std::vector<int> taken = take_all(store);
        std::ranges::sort(taken);
        std::ranges::sort(bricks);
        CHECK(taken == bricks);
        CHECK(store.bytes() <= 6 * BRICK_BYTES);
    }
    // The owner's own brick may be added to those that the loaders hold.
    CHECK(store.peak_bytes() <= 7 * BRICK_BYTES);
}

TEST_CASE("a store whose loaders wait for a network reads more bricks at once")
{
    /// Answers once FAR_LOADERS bricks are being read.
    class Far : public Row {
    public:
        using Row::Row;
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override
        {
            ++reading;
            while (reading < BrickStore::FAR_LOADERS) {
                stop_if_wait_is_over();
                std::this_thread::yield();
            }
            Row::read(box, voxels);
        }
        mutable std::atomic<int> reading = 0;
    };
    const Far source(BrickStore::FAR_LOADERS);
    BrickStore store(source, WINDOW, 64 * BRICK_BYTES, 1);
    std::vector<BrickKey> keys;
    for (int x = 0; x < BrickStore::FAR_LOADERS; ++x) keys.push_back({0, {x, 0, 0}});
    store.want(keys);
    size_t taken = 0;
    while (taken < keys.size() && store.wait()) taken += store.take(keys.size()).size();
    CHECK(taken == keys.size());
    CHECK(source.reading == BrickStore::FAR_LOADERS);
}

TEST_CASE("a store ends while its loaders wait for a network that never answers")
{
    class Silent : public Row {
    public:
        using Row::Row;
        void read(const VoxelBox&, std::span<std::byte>) const override
        {
            ++reading;
            for (;;) stop_if_wait_is_over();
        }
        mutable std::atomic<int> reading = 0;
    };
    const Silent source(4);
    BrickStore store(source, WINDOW, 64 * BRICK_BYTES, 2);
    store.want({{0, {0, 0, 0}}, {0, {1, 0, 0}}, {0, {2, 0, 0}}});
    while (source.reading < 3) std::this_thread::yield();
}
