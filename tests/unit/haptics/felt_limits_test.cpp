// Limits of what can be felt: chosen groups, and what the picture shows.

#include "engine/live/felt_limits.h"

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/live/relevance_host.h"
#include "engine/volume/levels/pyramid_source.h"
#include "engine/volume/voxel_numbers.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const Size3 NOISE_SIZE(50, 40, 36);
constexpr double HIGHEST_VALUE = 65535.0;

Mask random_mask(std::mt19937& random)
{
    Mask mask(NOISE_SIZE);
    const Size3 counts = mask.brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; ++brick) {
        MaskBrickChange change{.brick = brick, .runs = {}};
        const VoxelBox box = mask.box_of(brick);
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                    const size_t at = index_in_brick({x, y, z});
                    append_run(change.runs, at, at, uint8_t{0}, uint8_t(random() % 5));
                }
        mask.apply(change, Direction::forwards);
    }
    return mask;
}

std::shared_ptr<const VolumeSource> noise_source(const glm::dvec3& spacing)
{
    VolumeInfo info;
    info.name = "noise";
    info.size = NOISE_SIZE;
    info.type = VoxelType::uint16;
    info.spacing = spacing;
    std::mt19937 random(14);
    std::vector<std::byte> bytes(size_t(2 * NOISE_SIZE.x * NOISE_SIZE.y * NOISE_SIZE.z));
    for (std::byte& byte : bytes) byte = std::byte(random());
    return std::make_shared<MemorySource>(info, std::move(bytes));
}

/// Shows intensities from 20000 to 30000 and above 40000.
TransferFunction two_bands()
{
    return TransferFunction({{20000.0, glm::dvec3(1.0), 0.0},
                             {25000.0, glm::dvec3(1.0), 0.5},
                             {30000.0, glm::dvec3(1.0), 0.0},
                             {40000.0, glm::dvec3(1.0), 0.0},
                             {50000.0, glm::dvec3(1.0), 0.2}});
}

uint32_t bit_of(const RelevanceBits& bits, const Size3& at)
{
    const Size3 size = bits.box.size();
    return bits.words[size_t(at.x / 32 + bits.words_per_row * (at.y + size.y * at.z))] >> (at.x % 32) & 1u;
}

}  // namespace

TEST_CASE(
    "intensities that a function shows are those where its opacity is above 0, outside the window those of its ends")
{
    std::mt19937 random(11);
    for (int i = 0; i < 200; ++i) {
        std::vector<ControlPoint> points(random() % 6);
        for (ControlPoint& point : points) {
            point.intensity = double(random() % 40);
            point.opacity = random() % 2 ? 0.0 : 0.25;
        }
        const TransferFunction function(points);
        const IntensityWindow window{.lower = 5.0, .codes_per_unit = 65535.0 / 25.0};
        const IntensityIntervals shown = shown_intensities(function, window);
        for (double intensity = -4.0; intensity < 44.0; intensity += 0.25)
            CHECK(contains(shown, intensity) ==
                  (function.at(std::clamp(intensity, window.lower, window.upper())).a > 0.0));
        for (const ControlPoint& point : points)
            for (const double side : {-1.0, 1.0}) {
                const double beside = std::nextafter(point.intensity, side * HIGHEST_VALUE);
                if (beside > window.lower && beside < window.upper())
                    CHECK(contains(shown, beside) == (function.at(beside).a > 0.0));
            }
    }
}

TEST_CASE("a picture that hides nothing above the threshold limits nothing")
{
    const VolumeInfo info = noise_source(glm::dvec3(1.0))->info();
    const IntensityWindow window{.lower = 0.0, .codes_per_unit = 1.0};
    Look look;
    look.transfer_function = TransferFunction({{10000.0, glm::dvec3(1.0), 0.0}, {HIGHEST_VALUE, glm::dvec3(1.0), 1.0}});
    look.groups[3].name = "shown";
    FeltLimits limits = limits_of_groups({});
    limit_to_seen(look, Camera{}, info, window, 20000.0, limits);
    CHECK(limits == FeltLimits{});
    CHECK(!limits.need_mask());
    look.groups[3].opacity = 0.0;
    limit_to_seen(look, Camera{}, info, window, 20000.0, limits);
    CHECK(limits.groups.count() == 255);
    limits = limits_of_groups({3, 5});
    limit_to_seen(look, Camera{}, info, window, 5000.0, limits);
    CHECK(limits.groups == std::bitset<256>().set(5));
    CHECK(!limits.unpainted);  // no unpainted voxel is felt anyway
    // Where no unpainted voxel at or above the threshold is seen, intensities need not be compared.
    look.transfer_function = two_bands();
    limits = limits_of_groups({});
    limit_to_seen(look, Camera{}, info, window, 65000.0, limits);
    CHECK(!limits.unpainted);
    look.transfer_function = TransferFunction({{10.0, glm::dvec3(1.0), 0.0}, {20.0, glm::dvec3(1.0), 0.0}});
    limits = limits_of_groups({});
    limit_to_seen(look, Camera{}, info, window, 5000.0, limits);
    CHECK(!limits.groups[0]);
    CHECK(!limits.unpainted);
}

// Kind (Touch): what is cut away, transparent or in hidden groups is not felt
TEST_CASE("voxels are felt where they are seen: between planes, of a shown group, or unpainted and opaque")
{
    std::mt19937 random(13);
    const glm::dvec3 spacing(1.0, 1.5, 2.0);
    const auto source = with_levels(noise_source(spacing), uint64_t{1} << 30);
    const Mask mask = random_mask(random);
    Look look;
    look.transfer_function = two_bands();
    look.groups[2].visible = false;
    look.groups[3].opacity = 0.0;
    look.groups[4].parent = 2;
    look.cut = {{4.0, 3.5, 2.0}, {45.0, 33.25, 36.0}};
    look.cut.plane_normal = glm::dvec3(1.0, -0.37, 0.21);
    look.cut.plane_point = glm::dvec3(38.13, 20.0, 18.0);
    Camera camera;
    camera.eye = {25.0, 30.0, -100.0};
    camera.target = {25.0, 32.0, 36.0};
    camera.near_distance = 120.0;
    camera.far_distance = 160.0;
    const IntensityWindow window{.lower = 0.0, .codes_per_unit = 1.0};
    constexpr double THRESHOLD = 15000.0;
    FeltLimits limits;
    limit_to_seen(look, camera, source->info(), window, THRESHOLD, limits);
    REQUIRE(limits.unpainted);
    for (const int level : {0, 1}) {
        CAPTURE(level);
        const VoxelBox box{Size3(3, 2, 1) / int64_t(level + 1), size_of_level(NOISE_SIZE, level)};
        RelevanceBits bits = relevance_on_host(*source, level, box, THRESHOLD, limits, &mask);
        apply_limits(limits, source->info().spacing, &mask, bits);
        const RelevanceBits all = relevance_on_host(*source, level, box, THRESHOLD);
        const Size3 boxed = box.size();
        const int64_t step = int64_t{1} << level;
        size_t wrong = 0, felt = 0, relevant = 0;
        for (int64_t z = 0; z < boxed.z; ++z)
            for (int64_t y = 0; y < boxed.y; ++y)
                for (int64_t x = 0; x < boxed.x; ++x) {
                    const Size3 at = box.lower + Size3(x, y, z);
                    double intensity = 0.0;
                    std::vector<std::byte> bytes(bytes_of(source->info().type));
                    source->read_level(level, {at, at + int64_t{1}}, bytes);
                    load_voxels(source->info().type, bytes.data(), {&intensity, 1});
                    std::map<uint8_t, int> painted;
                    int voxels = 0;
                    for (int i = 0; i < step * step * step; ++i) {
                        const Size3 voxel = at * step + Size3(i & 1, i >> 1 & 1, i >> 2);
                        if (glm::any(glm::greaterThanEqual(voxel, NOISE_SIZE))) continue;
                        ++painted[mask.at(voxel)], ++voxels;
                    }
                    const int seen = painted[0] + painted[1], hidden = painted[2] + painted[3] + painted[4];
                    const bool is_painted = 2 * (voxels - painted[0]) >= voxels && voxels > painted[0];
                    const glm::dvec3 middle = (glm::dvec3(at) + 0.5) * double(step);
                    const double depth = glm::dot(middle * spacing - camera.eye, axes_of(camera).forward);
                    const bool is_between =
                        glm::all(glm::greaterThanEqual(middle, look.cut.lower)) &&
                        glm::all(glm::lessThan(middle, look.cut.upper)) &&
                        glm::dot(*look.cut.plane_normal, (middle - *look.cut.plane_point) * spacing) <= 0.0 &&
                        depth >= 120.0 && depth <= 160.0;
                    const bool expected = intensity >= THRESHOLD && is_between && seen > 0 && seen >= hidden &&
                                          (is_painted || look.transfer_function.at(intensity).a > 0.0);
                    wrong += expected != bool(bit_of(bits, {x, y, z}));
                    felt += expected;
                    relevant += bit_of(all, {x, y, z});
                }
        CHECK(wrong == 0);
        CHECK(felt > 500);
        CHECK(felt < relevant / 2);
    }
}
