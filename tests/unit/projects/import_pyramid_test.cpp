// Levels and ranges compared with their definitions, voxel by voxel.

#include "engine/projects/levels/import_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/formats/zarr/project.h"
#include "engine/volume/source.h"
#include "engine/volume/voxel_dispatch.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

template <class T>
struct Block {
    Size3 size{0};
    std::vector<T> voxels;
    const T& at(int64_t x, int64_t y, int64_t z) const { return voxels[size_t(x + size.x * (y + size.y * z))]; }
};

template <class T>
Block<T> random_block(const Size3& size, uint32_t seed, double share_of_nan = 0.0)
{
    std::mt19937 numbers(seed);
    Block<T> block{size, {}};
    for (int64_t i = 0; i < size.x * size.y * size.z; ++i) {
        const double share = double(numbers()) / 4294967296.0;
        if constexpr (std::is_integral_v<T>) {
            using Limits = std::numeric_limits<T>;
            block.voxels.push_back(static_cast<T>(
                std::floor(double{Limits::min()} + share * (double{Limits::max()} - double{Limits::min()} + 1.0))));
        } else {
            block.voxels.push_back(share < share_of_nan ? std::numeric_limits<T>::quiet_NaN()
                                                        : static_cast<T>(share - 0.5));
        }
    }
    return block;
}

/// Calls `function(value)` for every finite voxel of `block` in the box, clipped to the block.
template <class T, class Function>
void for_each_finite(const Block<T>& block, const Size3& lower, const Size3& upper, const Function& function)
{
    for (int64_t z = std::max<int64_t>(0, lower.z); z < std::min(block.size.z, upper.z); ++z)
        for (int64_t y = std::max<int64_t>(0, lower.y); y < std::min(block.size.y, upper.y); ++y)
            for (int64_t x = std::max<int64_t>(0, lower.x); x < std::min(block.size.x, upper.x); ++x)
                if (std::isfinite(double(block.at(x, y, z)))) function(double(block.at(x, y, z)));
}

template <class T>
Block<T> halved(const Block<T>& fine)
{
    Block<T> coarse{size_of_level(fine.size, 1), {}};
    for (int64_t z = 0; z < coarse.size.z; ++z)
        for (int64_t y = 0; y < coarse.size.y; ++y)
            for (int64_t x = 0; x < coarse.size.x; ++x) {
                double sum = 0.0;
                int count = 0;
                for_each_finite(fine, {2 * x, 2 * y, 2 * z}, {2 * x + 2, 2 * y + 2, 2 * z + 2}, [&](double value) {
                    sum += value;
                    ++count;
                });
                const double mean = sum / count;
                coarse.voxels.push_back(static_cast<T>(std::is_integral_v<T> ? std::nearbyint(mean) : mean));
            }
    return coarse;
}

/// Adds the volume chunk by chunk and compares every level and every range.
template <class T>
void check_levels(const Block<T>& block, VoxelType type)
{
    const auto pyramid = make_import_pyramid(block.size, type, 2);
    std::vector<Block<T>> levels{block};
    while (int(levels.size()) < pyramid->levels()) levels.push_back(halved(levels.back()));
    const auto expect_chunk = [&](int level, const Size3& chunk) {
        const Block<T>& expected = levels[size_t(level)];
        const std::span<const std::byte> bytes = pyramid->gather(level, chunk, 1);
        const auto* const found = reinterpret_cast<const T*>(bytes.data());
        REQUIRE(bytes.size() == 64 * 64 * 64 * sizeof(T));
        for (int64_t i = 0; i < 64 * 64 * 64; ++i) {
            const Size3 at = chunk * int64_t{64} + Size3(i % 64, i / 64 % 64, i / 4096);
            const bool is_inside = glm::all(glm::lessThan(at, expected.size));
            const T value = is_inside ? expected.at(at.x, at.y, at.z) : T{};
            const bool is_equal = found[i] == value || (value != value && found[i] != found[i]) ||
                                  (!std::is_integral_v<T> && std::abs(double(found[i]) - double(value)) < 1e-7);
            if (!is_equal) FAIL_CHECK("level ", level, " voxel ", at.x, " ", at.y, " ", at.z);
        }
    };
    const auto expect_layer = [&](int level, int64_t layer) {
        const Size3 chunks = size_of_level(levels[size_t(level)].size, 6);
        for (int64_t y = 0; y < chunks.y; ++y)
            for (int64_t x = 0; x < chunks.x; ++x) expect_chunk(level, {x, y, layer});
    };

    const size_t row_bytes = size_t(block.size.x) * sizeof(T);
    const Size3 chunks = size_of_level(block.size, 6);
    for (int64_t z = 0; z < chunks.z; ++z) {
        for (int64_t i = 0; i < chunks.x * chunks.y; ++i) {
            const Size3 origin = Size3(i % chunks.x, i / chunks.x, z) * int64_t{64};
            pyramid->add({.origin = origin,
                          .extent = glm::min(Size3(64), block.size - origin),
                          .voxels = reinterpret_cast<const std::byte*>(&block.at(origin.x, origin.y, origin.z)),
                          .row_bytes = row_bytes,
                          .slice_bytes = row_bytes * size_t(block.size.y)},
                         0);
        }
        const int64_t slices = std::min(block.size.z, 64 * (z + 1));
        for (int level = 1; level < pyramid->levels(); ++level) {
            if (!pyramid->completes_layer(level, slices)) continue;
            expect_layer(level, (size_of_level(Size3(slices), level).z - 1) / 64);
            pyramid->clear_layer(level);
        }
    }
    pyramid->finish();
    for (int level = 6; level < pyramid->levels(); ++level) expect_layer(level, 0);

    for (int level = 0; level < pyramid->levels(); ++level) {
        const std::vector<std::byte> ranges = pyramid->ranges(level);
        const Size3 bricks = size_of_level(levels[size_t(level)].size, 5);
        REQUIRE(ranges.size() == size_t(bricks.x * bricks.y * bricks.z) * 2 * sizeof(T));
        for (int64_t i = 0; i < bricks.x * bricks.y * bricks.z; ++i) {
            const Size3 brick(i % bricks.x, i / bricks.x % bricks.y, i / bricks.x / bricks.y);
            const int64_t side = int64_t{1} << level;
            ValueRange expected{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
            for_each_finite(block, (brick * int64_t{32} - int64_t{1}) * side,
                            (brick * int64_t{32} + int64_t{33}) * side, [&](double value) {
                                expected.lower = std::min(expected.lower, value);
                                expected.upper = std::max(expected.upper, value);
                            });
            const ValueRange found =
                range_of(type, std::span(ranges).subspan(size_t(i) * 2 * sizeof(T), 2 * sizeof(T)));
            if (expected.lower > expected.upper) {
                CHECK(found.lower > found.upper);
            } else if (!(found == expected)) {
                FAIL_CHECK("level ", level, " brick ", brick.x, " ", brick.y, " ", brick.z);
            }
        }
    }
}

}  // namespace

TEST_CASE("levels are means, ties to even, and ranges cover what lies below a brick and a voxel around, in every type")
{
    for (const VoxelType type : VOXEL_TYPES) {
        CAPTURE(name_of(type));
        with_voxel_type(type, [&]<class T>(T) {
            check_levels(random_block<T>(Size3(70, 65, 131), 1), type);
            check_levels(random_block<T>(Size3(33, 1, 2), 2), type);
            check_levels(random_block<T>(Size3(1), 3), type);
        });
    }
}

TEST_CASE("levels above the sixth are made of what is kept whole")
{
    check_levels(random_block<uint8_t>(Size3(3, 5, 4500), 4), VoxelType::uint8);
    check_levels(random_block<int16_t>(Size3(4400, 70, 3), 5), VoxelType::int16);
    check_levels(random_block<float>(Size3(2, 4300, 66), 6, 0.3), VoxelType::float32);
}

TEST_CASE("voxels that are no numbers count for neither means nor ranges")
{
    check_levels(random_block<float>(Size3(40, 70, 66), 7, 0.2), VoxelType::float32);
    check_levels(random_block<double>(Size3(33, 20, 9), 8, 0.9), VoxelType::float64);
    Block<float> none{Size3(65, 64, 33), {}};
    none.voxels.assign(65 * 64 * 33, std::numeric_limits<float>::quiet_NaN());
    check_levels(none, VoxelType::float32);
}

TEST_CASE("there are levels until one brick holds all")
{
    CHECK(level_count(Size3(1)) == 1);
    CHECK(level_count(Size3(32)) == 1);
    CHECK(level_count(Size3(33, 1, 1)) == 2);
    CHECK(level_count(Size3(512)) == 5);
    CHECK(level_count(Size3(1, 513, 1)) == 6);
    CHECK(level_count(Size3(1 << 20, 1, 1)) == 16);
}

TEST_CASE("what a pyramid saves is what it goes on with")
{
    const Block<uint16_t> block = random_block<uint16_t>(Size3(80, 70, 128), 9);
    const TemporaryFolder folder;
    const auto add = [&](ImportPyramid& pyramid, int64_t layer) {
        for (int64_t i = 0; i < 4; ++i) {
            const Size3 origin = Size3(i % 2, i / 2, layer) * int64_t{64};
            pyramid.add({.origin = origin,
                         .extent = glm::min(Size3(64), block.size - origin),
                         .voxels = reinterpret_cast<const std::byte*>(&block.at(origin.x, origin.y, origin.z)),
                         .row_bytes = 160,
                         .slice_bytes = 160 * 70},
                        0);
        }
    };
    const auto whole = make_import_pyramid(block.size, VoxelType::uint16, 1);
    add(*whole, 0);
    StateWriter writer;
    whole->save(writer);
    writer.write(folder.path / "state");
    const auto resumed = make_import_pyramid(block.size, VoxelType::uint16, 1);
    StateReader reader(folder.path / "state");
    resumed->load(reader);
    add(*whole, 1);
    add(*resumed, 1);
    for (int level = 0; level < whole->levels(); ++level) {
        CHECK(whole->ranges(level) == resumed->ranges(level));
        if (level == 0) continue;
        const auto expected = whole->gather(level, Size3(0), 0);
        const auto found = resumed->gather(level, Size3(0), 0);
        CHECK(std::equal(expected.begin(), expected.end(), found.begin(), found.end()));
    }
    CHECK(contains(error_of([&] { reader.take(); }), "is damaged, or of another version"));
    const auto other = make_import_pyramid(Size3(80, 70, 200), VoxelType::uint16, 1);
    StateReader again(folder.path / "state");
    CHECK(contains(error_of([&] { other->load(again); }), "is damaged, or of another version"));
}

TEST_CASE("a state that was cut short or changed is refused")
{
    const TemporaryFolder folder;
    StateWriter writer;
    writer.put(std::string("identity"));
    writer.put_all(std::vector<int64_t>{1, 2, 3});
    writer.write(folder.path / "state");
    std::ifstream file(folder.path / "state", std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(file), {}};
    {
        StateReader reader(folder.path / "state");
        CHECK(reader.take_text() == "identity");
        std::vector<int64_t> numbers(3);
        reader.take_all(numbers);
        CHECK(numbers == std::vector<int64_t>{1, 2, 3});
    }
    for (size_t length = 0; length < whole.size(); ++length) {
        CHECK(!error_of([&] { StateReader(folder.write("cut", whole.substr(0, length))); }).empty());
    }
    for (size_t at = 0; at < whole.size() * 8; ++at) {
        std::string spoiled = whole;
        spoiled[at / 8] = char(spoiled[at / 8] ^ char(1 << at % 8));
        // A changed bit of the frame's header may mean the same; the result must still equal what was written.
        try {
            StateReader reader(folder.write("spoiled", spoiled));
            CHECK(reader.take_text() == "identity");
        } catch (const Error& error) {
            CHECK(contains(error.what(), "is damaged, or of another version"));
        }
    }
}
