// Growing from seeds; against tests/reference/group_operations.h.

#include <cstring>

#include "engine/annotation/operations/flood_queues.h"
#include "engine/base/error.h"
#include "tests/unit/annotation/operations/operation_cases.h"

using namespace shvr;
using namespace shvr::test;

using On = GrowSeedsOp::On;

namespace {

constexpr On COSTS[] = {On::gradient, On::intensity, On::inverted};

/// A volume of any type whose values are a function of the position.
class TypedSource final : public VolumeSource {
public:
    TypedSource(const Size3& size, VoxelType type, std::function<double(const Size3&)> value)
        : VolumeSource(info_of(size, type)), value_(std::move(value))
    {}
    static VolumeInfo info_of(const Size3& size, VoxelType type)
    {
        VolumeInfo info = PatternSource::info_of(size, {1, 1, 1});
        info.type = type;
        return info;
    }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t next = 0;
        reference::for_each_voxel(box.size(), [&](const Size3& voxel) {
            const double value = value_(box.lower + voxel);
            const auto store = [&](auto as) { std::memcpy(&voxels[next], &as, sizeof as), next += sizeof as; };
            switch (info().type) {
                case VoxelType::int8: return store(int8_t(value));
                case VoxelType::uint16: return store(uint16_t(value));
                case VoxelType::int16: return store(int16_t(value));
                case VoxelType::float32: return store(float(value));
                default: return store(value);
            }
        });
        reads.push_back(box);
    }
    mutable std::vector<VoxelBox> reads{};

private:
    std::function<double(const Size3&)> value_;
};

DenseGroups two_seeds(const Size3& size, const Size3& a, const Size3& b)
{
    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
    dense.at(a) = 1;
    dense.at(b) = 2;
    return dense;
}

}  // namespace

// Kind (operations on groups): seeds that touch borders, walls of locked and other groups, ties of costs
TEST_CASE("growing from seeds agrees with its definition, whatever limits, locks and margins")
{
    std::mt19937 random(41);
    const glm::dvec3 spacings[] = {{1, 1, 1}, {0.5, 0.75, 1.25}, {3e-7, 2e-7, 2e-7}, {1, 2, 3}};
    const Size3 sizes[] = {{33, 31, 1}, {32, 40, 32}, {45, 37, 20}, {34, 33, 35}};
    for (size_t i = 0; i < std::size(sizes); ++i)
        for (const On on : COSTS) {
            CAPTURE(i);
            const DenseGroups before = random_groups(random, sizes[i], 4);
            GrowSeedsOp op{.on = on, .margin = int64_t(random() % 12)};
            check_operation(op, before, spacings[i]);
            op = {.groups = {1, 2, 3}, .on = on, .limits = random_limits(random, sizes[i])};
            GroupSet locked;
            locked[2 + random() % 3] = true;
            const OperationResult result = check_operation(op, before, spacings[i], locked);
            CHECK(result.kept_locked.empty());
            CHECK(result.kept_by_limits == 0);
        }
}

// Kind (operations on groups): intensities below 0, of two bytes, fractions, NaN and infinities
TEST_CASE("growing from seeds agrees with its definition for every kind of intensity")
{
    const Size3 size(23, 35, 9);
    std::mt19937 random(42);
    const DenseGroups before = random_groups(random, size, 2);
    Mask mask = mask_of(before);
    const auto hash = [&](const Size3& voxel) {
        return (voxel.x * 7919 + voxel.y * 104729 + voxel.z * 1299709) % 65521;
    };
    const auto with_gaps = [&](const Size3& voxel) {
        const int64_t number = hash(voxel);
        return number % 17 == 0   ? std::numeric_limits<double>::quiet_NaN()
               : number % 19 == 0 ? std::numeric_limits<double>::infinity()
                                  : double(number) / 7.0 - 3000.0;
    };
    const auto shifted = [&](double from, double scale) {
        return [=](const Size3& voxel) { return from + std::floor(double(hash(voxel)) * scale); };
    };
    struct Case {
        VoxelType type;
        std::function<double(const Size3&)> value;
    };
    for (const Case& each :
         {Case{VoxelType::int8, shifted(-128, 255.0 / 65520)}, Case{VoxelType::uint16, shifted(0, 65535.0 / 65520)},
          Case{VoxelType::uint16, shifted(5, 2.0 / 65520)},  // ties
          Case{VoxelType::int16, shifted(-32768, 65535.0 / 65520)}, Case{VoxelType::float32, with_gaps},
          Case{VoxelType::float64, with_gaps}})
        for (const On on : COSTS) {
            const TypedSource source(size, each.type, each.value);
            const GrowSeedsOp op{.on = on, .margin = 40};
            const OperationResult result = run(op, {.mask = mask, .volume = source.info(), .source = &source});
            reference::DenseVolume volume{{1, 1, 1}, {}, nullptr, {}};
            reference::for_each_voxel(size, [&](const Size3& voxel) {
                const double value = each.value(voxel);
                volume.intensities.push_back(each.type == VoxelType::float32 ? double(float(value)) : value);
            });
            apply(mask, result.changes);
            CHECK((dense_of(mask).groups == reference::wanted(op, before, volume).groups));
            apply(mask, result.changes, Direction::backwards);
        }
}

TEST_CASE("seeds meet on edges, on bright ridges, or in dark valleys")
{
    const Size3 size(21, 9, 5);
    DenseGroups before = two_seeds(size, {2, 4, 2}, {18, 4, 2});
    const Mask mask = mask_of(before);
    const auto border_of = [&](On on, const std::function<double(const Size3&)>& value) {
        const TypedSource source(size, VoxelType::uint16, value);
        Mask grown = mask;
        test::apply(grown,
                    run(GrowSeedsOp{.on = on}, {.mask = mask, .volume = source.info(), .source = &source}).changes);
        int64_t border = 0;
        for (; border < size.x && grown.at({border, 4, 2}) == 1; ++border) {
        }
        for (int64_t x = 0; x < size.x; ++x)
            for (int64_t y = 0; y < size.y; ++y) CHECK(grown.at({x, y, 1}) == (x < border ? 1 : 2));
        return border;
    };
    const auto step = [](const Size3& voxel) { return voxel.x < 14 ? 100.0 : 1000.0; };
    const auto ridge = [](const Size3& voxel) { return voxel.x == 6 ? 900.0 : 10.0; };
    const auto valley = [](const Size3& voxel) { return voxel.x == 15 ? 10.0 : 900.0; };
    CHECK(border_of(On::gradient, step) == 14);
    CHECK(std::abs(border_of(On::intensity, ridge) - 6) <= 1);
    CHECK(std::abs(border_of(On::inverted, valley) - 15) <= 1);
}

TEST_CASE("growing from seeds costs its box, not the volume, within the budget")
{
    const Size3 size(int64_t{1} << 20);
    Mask mask(size);
    const auto add = [&](const Size3& at, uint8_t group) {
        const auto index = uint16_t(index_in_brick(at));
        mask.apply({.brick = index_of(at / BRICK_SIDE, mask.brick_counts()), .runs = {{index, index, 0, group}}},
                   Direction::forwards);
    };
    add({640'010, 70, 900'010}, 1);
    add({640'020, 70, 900'010}, 2);
    const TypedSource source(size, VoxelType::uint16, [](const Size3&) { return 7.0; });
    OperationInput input{.mask = mask, .volume = source.info(), .source = &source};
    OperationResult result = run(GrowSeedsOp{.margin = 4}, input);
    CHECK(result.voxels == 19 * 9 * 9 - 2);
    CHECK(result.bricks_written == 1);
    CHECK(result.bricks_of_intensities == 1);
    CHECK(result.bricks_read == 3);  // to find the seeds, to prepare the box and to write it
    const auto voxels_read = [&] {
        int64_t sum = 0;
        for (const VoxelBox& box : source.reads) sum += box.size().x * box.size().y * box.size().z;
        return sum;
    };
    CHECK(voxels_read() == 21 * 11 * 11);
    add({5, 5, 5}, 3);
    input.memory = 64 << 20;
    CHECK_THROWS_WITH_AS(
        static_cast<void>(run(GrowSeedsOp{}, input)),
        doctest::Contains("the box in which the groups grow is [0,0,0,640037,87,900027] (640037 x 87 x 900027 voxels)"),
        Error);
    CHECK_THROWS_WITH_AS(static_cast<void>(run(GrowSeedsOp{}, input)),
                         doctest::Contains("expected at most 64 MiB, the budget of the host"), Error);
    input.memory = 0;
    CHECK_THROWS_WITH_AS(static_cast<void>(run(GrowSeedsOp{}, input)), doctest::Contains("expected fewer than 2^32"),
                         Error);
    const VoxelBox box{{640'000, 60, 900'000}, {640'030, 80, 900'020}};
    result = run(GrowSeedsOp{.limits = {.box = box}}, input);  // far from the third seed
    CHECK(result.voxels == 30 * 20 * 20 - 2);
    CHECK(result.note == "grown in the box [640000,60,900000,640030,80,900020]");
}

TEST_CASE(
    "growing from seeds needs seeds that are not locked, stops when it is told to, and says what it did not reach")
{
    DenseGroups before = two_seeds({20, 9, 9}, {2, 4, 4}, {17, 4, 4});
    for (int64_t y = 0; y < 9; ++y)
        for (int64_t z = 0; z < 9; ++z) before.at({10, y, z}) = 3;
    GroupSet locked;
    locked[3] = locked[2] = true;
    const OperationResult result = check_operation(GrowSeedsOp{}, before, {1, 1, 1}, locked);
    CHECK(result.voxels == 10 * 81 - 1);
    CHECK(result.note == "grown in the box [0,0,0,19,9,9], where no seed reaches 647 voxels");
    const auto failure = [&](const GrowSeedsOp& op) -> std::string {
        try {
            check_operation(op, before, {1, 1, 1}, locked);
        } catch (const Error& error) {
            return error.what();
        }
        return {};
    };
    CHECK(failure({.groups = {2, 3}}) == "no group of [2,3] that is not locked has voxels; expected some as seeds");
    CHECK(failure({.limits = {.box = VoxelBox{{5, 0, 0}, {9, 9, 9}}}}) ==
          "no group that is not locked has voxels in the box [5,0,0,9,9,9]; expected some as seeds");
    const Mask mask = mask_of(before);
    const PatternSource source(before.size, {1, 1, 1});
    double last = 0.0;
    const auto stop = [&](double fraction) {
        CHECK(fraction >= last);
        last = fraction;
        if (fraction >= 0.9) throw Stopped("stopped");
    };
    CHECK_THROWS_AS(
        static_cast<void>(run(GrowSeedsOp{}, {.mask = mask, .volume = source.info(), .source = &source}, stop)),
        Stopped);
}

TEST_CASE("queues of floods return the lowest cost, of equal costs the first")
{
    std::mt19937 random(43);
    BucketQueue buckets(20'000);
    HeapQueue heap(20'000);
    std::multimap<double, uint32_t> expected;
    uint32_t pushed = 0;
    while (pushed < 20'000 || !expected.empty()) {
        const bool grows = random() % 3 != 0;
        for (uint32_t i = uint32_t(random() % 500); i > 0 && grows && pushed < 20'000; --i, ++pushed) {
            const auto cost = double(random() % (random() % 2 == 0 ? 40 : 65536));
            expected.emplace(cost, pushed);
            buckets.push(pushed, cost);
            heap.push(pushed, cost);
        }
        if (expected.empty()) continue;
        REQUIRE(buckets.pop() == expected.begin()->second);
        REQUIRE(heap.pop() == expected.begin()->second);
        expected.erase(expected.begin());
        REQUIRE(buckets.is_empty() == expected.empty());
        REQUIRE(heap.is_empty() == expected.empty());
    }
}
