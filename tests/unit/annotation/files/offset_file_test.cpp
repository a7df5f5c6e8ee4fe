#include "engine/annotation/files/offset_file.h"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Mostly without offsets.
template <class Offset>
std::string random_offsets(const Size3& size, double most, uint32_t seed)
{
    std::mt19937 random(seed);
    std::vector<Offset> offsets(size_t(size.x * size.y * size.z));
    for (Offset& offset : offsets)
        if (random() % 5 == 0)
            offset = static_cast<Offset>(std::uniform_real_distribution<double>(-most, most)(random));
    return {reinterpret_cast<const char*>(offsets.data()), offsets.size() * sizeof(Offset)};
}

template <class Offset>
void check_file(VoxelType type, double most)
{
    CAPTURE(name_of(type));
    const TemporaryFolder folder;
    for (const Size3& size : {Size3(1, 1, 1), Size3(33, 31, 65), Size3(70, 5, 40), Size3(5, 70, 3)}) {
        const std::string content = random_offsets<Offset>(size, most, 3);
        const auto path = folder.write("a.offset", content);
        const DensityField field = load_offsets(path, size, type);
        size_t index = 0, wrong = 0;
        for (int64_t z = 0; z < size.z; ++z)
            for (int64_t y = 0; y < size.y; ++y)
                for (int64_t x = 0; x < size.x; ++x, ++index) {
                    Offset offset{};
                    std::memcpy(&offset, content.data() + index * sizeof(Offset), sizeof(Offset));
                    wrong += field.at({x, y, z}) != double(offset);
                }
        CHECK(wrong == 0);
        save_offsets(folder.path / "b.offset", field);
        CHECK((read_text(folder.path / "b.offset", 1 << 24) == content));
        CHECK_THROWS_AS(load_offsets(path, size + Size3(1, 0, 0), type), Error);
    }
}

}  // namespace

TEST_CASE("an offset file is one signed number a voxel, in and out, bit for bit")
{
    check_file<int16_t>(VoxelType::uint8, 255.0);
    check_file<int16_t>(VoxelType::int8, 255.0);
    check_file<int32_t>(VoxelType::uint16, 65535.0);
    check_file<int32_t>(VoxelType::int32, 2e9);
    check_file<float>(VoxelType::float32, 1e30);
    check_file<float>(VoxelType::float64, 1e-30);
}

TEST_CASE("offsets that no stroke makes, and files of another size, are refused in words")
{
    const TemporaryFolder folder;
    const auto refusal = [&](VoxelType type, const auto& numbers) {
        const std::string content(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
        return error_of([&] { load_offsets(folder.write("a.offset", content), {2, 2, 1}, type); });
    };
    CHECK(contains(refusal(VoxelType::uint8, std::array<int16_t, 4>{0, 0, 256, 0}),
                   "a.offset: the offset of voxel 0, 1, 0 is 256; expected -255 to 255 for a volume of uint8"));
    CHECK(contains(refusal(VoxelType::uint16, std::array<int32_t, 4>{0, -65536, 0, 0}), "voxel 1, 0, 0 is -65536"));
    CHECK(contains(refusal(VoxelType::int32, std::array<int32_t, 4>{0, 0, 0, std::numeric_limits<int32_t>::lowest()}),
                   "voxel 1, 1, 0 is -2147483648"));
    CHECK(contains(refusal(VoxelType::float32, std::array<float, 4>{0, 0, std::nanf(""), 0}), "is nan"));
    CHECK(contains(refusal(VoxelType::float64, std::array<float, 4>{INFINITY, 0, 0, 0}), "voxel 0, 0, 0 is inf"));
    CHECK(contains(refusal(VoxelType::uint8, std::array<int16_t, 5>{}),
                   "a.offset: holds 10 bytes; expected 8, 2 for each voxel of 2 x 2 x 1"));
    CHECK(contains(error_of([&] {
                       load_offsets(folder.path, {2, 2, 1}, VoxelType::uint8);
                   }),
                   "expected a .offset file"));
    CHECK(contains(error_of([&] { load_offsets(folder.path / "none", {2, 2, 1}, VoxelType::uint8); }), "none"));
    // -0 is no offset.
    const std::array<float, 4> zeros{-0.0f, 0, 0, 0};
    const auto path = folder.write("z.offset", std::string(reinterpret_cast<const char*>(zeros.data()), sizeof zeros));
    CHECK(load_offsets(path, {2, 2, 1}, VoxelType::float32).voxels() == 0);
}
