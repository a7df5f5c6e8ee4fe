// A volume with offsets: level 0 against plain sums, coarser levels against halving of the whole field, ranges against
// every voxel they speak of, and reads while offsets change.

#include "engine/volume/offset_source.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "engine/volume/halving.h"
#include "engine/volume/levels/pyramid_source.h"
#include "tests/support/bounds.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr int64_t SIDE = gpu::BRICK_SIZE;

template <class T>
std::vector<T> noise(const Size3& size, uint32_t seed)
{
    std::mt19937 random(seed);
    std::vector<T> voxels(size_t(size.x * size.y * size.z));
    for (T& voxel : voxels) voxel = static_cast<T>(random());
    return voxels;
}

/// A whole field of offsets, and the bricks of it.
template <class Offset>
struct Field {
    Size3 size;
    std::vector<Offset> offsets;

    explicit Field(const Size3& of_size) : size(of_size), offsets(size_t(size.x * size.y * size.z)) {}
    Offset& at(const Size3& voxel) { return offsets[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))]; }
    OffsetSource::Brick brick(const glm::ivec3& where)
    {
        auto brick = std::make_shared<OffsetBrick>(OffsetBrick{});
        for (int64_t z = 0; z < SIDE; ++z)
            for (int64_t y = 0; y < SIDE; ++y)
                for (int64_t x = 0; x < SIDE; ++x) {
                    const Size3 voxel = SIDE * Size3(where) + Size3(x, y, z);
                    if (glm::all(glm::lessThan(voxel, size)))
                        (*brick)[size_t(x + SIDE * (y + SIDE * z))] = std::bit_cast<uint32_t>(at(voxel));
                }
        return {where, brick};
    }
    void halve()
    {
        const Size3 half = size_of_level(size, 1);
        Field<Offset> above(half);
        for (int64_t z = 0; z < half.z; ++z)
            for (int64_t y = 0; y < half.y; ++y) {
                HalvingRows<Offset> rows;
                for (int64_t slice = 2 * z; slice < std::min(2 * z + 2, size.z); ++slice)
                    for (int64_t line = 2 * y; line < std::min(2 * y + 2, size.y); ++line)
                        rows.first[size_t(rows.count++)] = &at({0, line, slice});
                halve_rows(rows, size.x, &above.at({0, y, z}));
            }
        *this = above;
    }
};

/// The sum in double, or whole numbers; clamped.
template <class T, class Offset>
T sum_of(T voxel, Offset offset)
{
    if constexpr (std::is_floating_point_v<T>) {
        return std::isfinite(voxel) ? static_cast<T>(double(voxel) + double(offset)) : voxel;
    } else {
        const int64_t sum = int64_t{voxel} + offset;
        return static_cast<T>(
            std::min<int64_t>(std::max<int64_t>(sum, std::numeric_limits<T>::lowest()), std::numeric_limits<T>::max()));
    }
}

template <class T, class Offset>
void check_levels(VoxelType type, Offset most)
{
    const Size3 size(70, 45, 99);
    std::vector<T> voxels = noise<T>(size, 3);
    if constexpr (std::is_floating_point_v<T>) {
        for (T& voxel : voxels) voxel = std::ldexp(voxel, -30);
        voxels[5] = std::numeric_limits<T>::quiet_NaN();
        voxels[6] = std::numeric_limits<T>::infinity();
    }
    const auto base = with_levels(std::make_shared<MemorySource>(memory_source(size, type, voxels)), 1 << 24);
    REQUIRE(base->levels() == 3);
    OffsetSource source(base);
    CHECK(source.empty());
    for (int level = 0; level < 3; ++level)
        CHECK(std::memcmp(level_of<T>(source, level).data(), level_of<T>(*base, level).data(),
                          level_of<T>(*base, level).size() * sizeof(T)) == 0);

    Field<Offset> field(size);
    std::mt19937 random(9);
    std::vector<OffsetSource::Brick> bricks;
    for (const glm::ivec3 where : {glm::ivec3(0), glm::ivec3(2, 1, 3), glm::ivec3(1, 0, 2), glm::ivec3(0, 1, 2)}) {
        for (int i = 0; i < 4000; ++i) {
            const Size3 voxel = SIDE * Size3(where) + Size3(random() % 32, random() % 32, random() % 32);
            if (glm::all(glm::lessThan(voxel, size)))
                field.at(voxel) =
                    static_cast<Offset>(std::uniform_real_distribution<double>(-1, 1)(random) * double(most));
        }
        bricks.push_back(field.brick(where));
    }
    source.set(bricks);
    CHECK_FALSE(source.empty());
    Field<Offset> at_level = field;
    for (int level = 0; level < 3; ++level) {
        CAPTURE(level);
        const std::vector<T> before = level_of<T>(*base, level), after = level_of<T>(source, level);
        size_t wrong = 0, raised = 0;
        for (size_t i = 0; i < before.size(); ++i) {
            const T expected = sum_of(before[i], at_level.offsets[i]);
            wrong += std::memcmp(&expected, &after[i], sizeof(T)) != 0;
            raised += std::memcmp(&before[i], &after[i], sizeof(T)) != 0;
        }
        CHECK(wrong == 0);
        CHECK(raised > 100);
        at_level.halve();
    }
    // Any box is a part of the whole.
    const VoxelBox box{{13, 9, 60}, {68, 41, 98}};
    const std::vector<T> part = voxels_in<T>(source, box), whole = level_of<T>(source, 0);
    size_t wrong = 0, index = 0;
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y)
            for (int64_t x = box.lower.x; x < box.upper.x; ++x, ++index)
                wrong += std::memcmp(&part[index], &whole[size_t(x + size.x * (y + size.y * z))], sizeof(T)) != 0;
    CHECK(wrong == 0);
    // Taken away again, nothing is left.
    for (OffsetSource::Brick& brick : bricks) brick.offsets = nullptr;
    source.set(bricks);
    CHECK(source.empty());
    CHECK(std::memcmp(level_of<T>(source, 2).data(), level_of<T>(*base, 2).data(),
                      level_of<T>(*base, 2).size() * sizeof(T)) == 0);
}

std::shared_ptr<OffsetBrick> constant(uint32_t bits)
{
    auto brick = std::make_shared<OffsetBrick>();
    brick->fill(bits);
    return brick;
}

/// Ranges as a project knows them: of every brick, exactly.
class Known final : public VolumeSource {
public:
    explicit Known(std::shared_ptr<const VolumeSource> source)
        : VolumeSource(source->info()), source_(std::move(source))
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { source_->read(box, voxels); }
    int levels() const override { return source_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_->read_level(level, box, voxels);
    }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return range_in(*source_, level, brick);
    }
    static ValueRange range_in(const VolumeSource& source, int level, const Size3& brick)
    {
        ValueRange range{1e9, -1e9};
        for (int below = level; below >= 0; --below) {
            const Size3 size = size_of_level(source.info().size, below);
            const int64_t side = SIDE << (level - below), apron = int64_t{1} << (level - below);
            const Size3 lower = glm::max(side * brick - apron, Size3(0));
            const Size3 upper = glm::min(side * (brick + int64_t{1}) + apron, size);
            const VoxelBox box{lower, upper};
            std::vector<uint8_t> voxels(size_t(box.size().x * box.size().y * box.size().z));
            source.read_level(below, box, std::as_writable_bytes(std::span(voxels)));
            for (const uint8_t voxel : voxels)
                range = {std::min(range.lower, double(voxel)), std::max(range.upper, double(voxel))};
        }
        return range;
    }

private:
    std::shared_ptr<const VolumeSource> source_;
};

}  // namespace

TEST_CASE("offsets are added exactly at level 0 and halved at coarser levels, and nothing else changes")
{
    check_levels<uint8_t, int32_t>(VoxelType::uint8, 255);
    check_levels<int16_t, int32_t>(VoxelType::int16, 65535);
    check_levels<uint32_t, int32_t>(VoxelType::uint32, 2147483647);
    check_levels<int32_t, int32_t>(VoxelType::int32, 2147483647);
    check_levels<float, float>(VoxelType::float32, 3.0f);
    check_levels<double, float>(VoxelType::float64, 3.0f);
}

TEST_CASE("offsets saturate and never wrap")
{
    const auto value = [](VoxelType type, auto voxel, double offset) {
        using T = decltype(voxel);
        const Size3 size(3, 2, 1);
        OffsetSource source(std::make_shared<MemorySource>(memory_source(size, type, std::vector<T>(6, voxel))));
        auto brick = std::make_shared<OffsetBrick>(OffsetBrick{});
        (*brick)[33] = offset_bits(type, offset);
        source.set(std::array{OffsetSource::Brick{{0, 0, 0}, brick}});
        CHECK(level_of<T>(source, 0)[3] == voxel);
        return level_of<T>(source, 0)[4];
    };
    const auto check = [&](VoxelType type, auto voxel, double offset, auto expected) {
        CAPTURE(std::string(name_of(type)));
        CAPTURE(offset);
        test::check_below("levels off the clamped sum", std::abs(double(value(type, voxel, offset)) - double(expected)),
                          0.0);
    };
    check(VoxelType::uint8, uint8_t{250}, 10, 255);
    check(VoxelType::uint8, uint8_t{5}, -10, 0);
    check(VoxelType::int8, int8_t{-120}, 255, 127);
    check(VoxelType::uint16, uint16_t{65000}, 65535, 65535);
    check(VoxelType::int16, int16_t{-32768}, -1, -32768);
    check(VoxelType::int16, int16_t{-32768}, 65535, 32767);
    check(VoxelType::uint32, uint32_t{4294967290}, 10, 4294967295u);
    check(VoxelType::int32, int32_t{-2147483600}, -2147483647, std::numeric_limits<int32_t>::lowest());
    check(VoxelType::float32, 3e38f, 3e38, std::numeric_limits<float>::max());
    check(VoxelType::float64, 0.5, 0.25, 0.75);
}

TEST_CASE("ranges hold every voxel with its offset, of all levels below and one voxel around")
{
    const Size3 size(130, 70, 100);
    std::vector<uint8_t> voxels = noise<uint8_t>(size, 5);
    for (uint8_t& voxel : voxels) voxel = uint8_t(100 + voxel / 8);
    const auto base = std::make_shared<Known>(
        with_levels(std::make_shared<MemorySource>(memory_source(size, VoxelType::uint8, voxels)), 1 << 24));
    OffsetSource source(base);
    for (int64_t x = 0; x < 3; ++x) CHECK((source.brick_range(0, {x, 0, 0}) == base->brick_range(0, {x, 0, 0})));
    auto single = std::make_shared<OffsetBrick>(OffsetBrick{});
    (*single)[0] = offset_bits(VoxelType::uint8, 120);
    auto corner = std::make_shared<OffsetBrick>(OffsetBrick{});
    (*corner)[OffsetBrick{}.size() - 1] = offset_bits(VoxelType::uint8, -250);
    source.set(std::array{OffsetSource::Brick{{1, 1, 1}, single}, OffsetSource::Brick{{2, 0, 2}, corner},
                          OffsetSource::Brick{{3, 1, 0}, constant(offset_bits(VoxelType::uint8, 77))}});
    int widened = 0;
    for (int level = 0; level < source.levels(); ++level) {
        const Size3 counts = (size_of_level(size, level) + (SIDE - 1)) / SIDE;
        for (int64_t i = 0; i < counts.x * counts.y * counts.z; ++i) {
            const Size3 brick(i % counts.x, i / counts.x % counts.y, i / (counts.x * counts.y));
            const ValueRange is = Known::range_in(source, level, brick);
            const ValueRange known = source.brick_range(level, brick).value();
            CHECK((known.lower <= is.lower && known.upper >= is.upper));
            CHECK((known.lower >= 0.0 && known.upper <= 255.0));
            widened += known != base->brick_range(level, brick).value();
        }
    }
    CHECK(widened > 20);
    CHECK_FALSE(source.statistics().has_value());
}

TEST_CASE("reads of other threads see offsets of before or of after, brick by brick, while they change")
{
    const Size3 size(64, 32, 32);
    OffsetSource source(
        with_levels(std::make_shared<MemorySource>(memory_source(
                        size, VoxelType::uint16, std::vector<uint16_t>(size_t(size.x * size.y * size.z), 100))),
                    1 << 24));
    std::atomic<bool> done = false;
    std::atomic<int> torn = 0, reads = 0;
    std::vector<std::jthread> readers;
    for (int i = 0; i < 3; ++i)
        readers.emplace_back([&] {
            while (!done) {
                const std::vector<uint16_t> voxels = voxels_in<uint16_t>(source, {{0, 5, 5}, {64, 9, 9}});
                // Both bricks are set together.
                torn += std::ranges::any_of(voxels, [&](uint16_t voxel) { return voxel != voxels.front(); });
                static_cast<void>(level_of<uint16_t>(source, 1));
                static_cast<void>(source.brick_range(1, {0, 0, 0}));
                ++reads;
            }
        });
    for (int i = 0; i < 300 || reads < 300; ++i) {
        const auto brick = i % 5 == 0 ? nullptr : constant(uint32_t(i % 5));
        source.set(std::array{OffsetSource::Brick{{0, 0, 0}, brick}, OffsetSource::Brick{{1, 0, 0}, brick}});
    }
    done = true;
    readers.clear();
    CHECK(torn == 0);
}
