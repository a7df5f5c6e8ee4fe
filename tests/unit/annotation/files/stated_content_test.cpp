// Distinguishes label images of other programs, which state nothing, from scans, by their voxels.

#include "engine/annotation/files/stated_content.h"

#include <functional>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr Size3 SIZE{40, 30, 20};

/// The verdict on a volume of type T; the function gives the value of each voxel.
template <class T>
std::string verdict(VoxelType type, const std::function<double(const Size3&)>& value)
{
    std::vector<T> voxels;
    for (int64_t z = 0; z < SIZE.z; ++z)
        for (int64_t y = 0; y < SIZE.y; ++y)
            for (int64_t x = 0; x < SIZE.x; ++x) voxels.push_back(T(value({x, y, z})));
    VolumeInfo info = volume_of_size(SIZE);
    info.type = type;
    const auto bytes = std::as_bytes(std::span(voxels));
    const MemorySource source(info, {bytes.begin(), bytes.end()});
    return labels_in_words(source, measure(source));
}

/// 1, 2, ...: which of some balls a voxel lies in; 0: in none.
int ball_at(const Size3& voxel, int balls)
{
    for (int ball = 0; ball < balls; ++ball) {
        const glm::dvec3 away = glm::dvec3(voxel) - glm::dvec3(7 + ball * 5 % 30, 8 + ball * 7 % 20, 5 + ball * 3 % 12);
        if (glm::dot(away, away) < 20.0) return ball + 1;
    }
    return 0;
}

}  // namespace

// Kind (Masks): label images of other programs, which state nothing: 0 and 255, 0 to 3, gaps, wide and signed types
TEST_CASE("labels are distinguished from intensities, in any type of integers")
{
    const auto balls = [](int count) { return [count](const Size3& voxel) { return double(ball_at(voxel, count)); }; };
    CHECK(verdict<uint8_t>(VoxelType::uint8, balls(3)) == "its voxels have the values 0 to 3 only");
    CHECK(verdict<uint16_t>(VoxelType::uint16, balls(1)) == "its voxels have the values 0 and 1 only");
    CHECK(verdict<int32_t>(VoxelType::int32, balls(5)) == "its voxels have the values 0 to 5 only");
    const auto of_fiji = [](const Size3& voxel) { return ball_at(voxel, 6) > 0 ? 255.0 : 0.0; };
    CHECK(verdict<uint8_t>(VoxelType::uint8, of_fiji) == "its voxels have the values 0 and 255 only");
    const auto with_gaps = [](const Size3& voxel) { return 40.0 * ball_at(voxel, 4); };
    CHECK(verdict<int16_t>(VoxelType::int16, with_gaps) ==
          "its voxels have the values 0 to 160, 5 different ones only");
}

// Kind (Masks): scans of few values: photon counts, one material, floats, values below 0 or above 255
TEST_CASE("volumes of few values that are no labels, or that no mask can hold, are scans")
{
    std::mt19937 random(3);
    const auto counts = [&](const Size3& voxel) { return ball_at(voxel, 6) > 0 ? double(random() % 6) : 0.0; };
    CHECK(verdict<uint8_t>(VoxelType::uint8, counts).empty());
    CHECK(verdict<uint8_t>(VoxelType::uint8, [&](const Size3&) { return double(random() % 256); }).empty());
    CHECK(verdict<uint8_t>(VoxelType::uint8, [](const Size3&) { return 0.0; }).empty());
    CHECK(verdict<uint8_t>(VoxelType::uint8, [](const Size3& voxel) {
              return ball_at(voxel, 2) > 0 ? 180.0 : 90.0;
          }).empty());
    const auto balls = [](const Size3& voxel) { return double(ball_at(voxel, 3)); };
    CHECK(verdict<float>(VoxelType::float32, balls).empty());
    CHECK(verdict<int16_t>(VoxelType::int16, [&](const Size3& voxel) { return balls(voxel) - 1.0; }).empty());
    CHECK(verdict<uint16_t>(VoxelType::uint16, [&](const Size3& voxel) { return 200.0 * balls(voxel); }).empty());
    const auto smooth = [](const Size3& voxel) { return double((voxel.x + voxel.y + voxel.z) / 8); };
    CHECK(verdict<uint8_t>(VoxelType::uint8, [&](const Size3& voxel) {
              return smooth(voxel) + double(random() % 2);
          }).empty());
}
