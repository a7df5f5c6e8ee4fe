#include "engine/volume/procedural/source_procedural.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/volume/procedural/procedural_hash.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

ProceduralSpec spec_of(const std::string& kind, const Size3& size, VoxelType type = VoxelType::uint8, uint32_t seed = 1)
{
    return {.kind = kind, .size = size, .seed = seed, .type = type};
}

std::vector<uint8_t> bytes_of_kind(const std::string& kind, const Size3& size, uint32_t seed = 1)
{
    return voxels_of<uint8_t>(*open_procedural(spec_of(kind, size, VoxelType::uint8, seed)));
}

/// FNV-1a.
uint64_t checksum(const std::vector<uint8_t>& bytes)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (const uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
    return hash;
}

template <class T>
void check_voxels_equal_field(const std::string& kind, VoxelType type)
{
    const ProceduralSpec spec = spec_of(kind, {40, 35, 50}, type, 3);
    const ScalarField field = procedural_field(spec);
    const VoxelBox box{{5, 3, 7}, {39, 31, 44}};
    const std::vector<T> voxels = voxels_in<T>(*open_procedural(spec), box);
    size_t at = 0;
    size_t wrong = 0;
    for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
        for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
            for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                const double value = field.value(glm::dvec3(x, y, z) + 0.5);
                const double expected = std::is_floating_point_v<T> ? value : std::floor(value + 0.5);
                wrong += voxels[at++] != static_cast<T>(expected);
            }
        }
    }
    CAPTURE(kind);
    CAPTURE(name_of(type));
    CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("the voxels of every kind are its field at their centres, rounded to the type")
{
    for (const std::string& kind : procedural_kinds()) {
        check_voxels_equal_field<uint8_t>(kind, VoxelType::uint8);
        check_voxels_equal_field<int8_t>(kind, VoxelType::int8);
        check_voxels_equal_field<uint16_t>(kind, VoxelType::uint16);
        check_voxels_equal_field<int16_t>(kind, VoxelType::int16);
        check_voxels_equal_field<uint32_t>(kind, VoxelType::uint32);
        check_voxels_equal_field<int32_t>(kind, VoxelType::int32);
        check_voxels_equal_field<float>(kind, VoxelType::float32);
        check_voxels_equal_field<double>(kind, VoxelType::float64);
    }
}

TEST_CASE("gradients are the derivatives of the field")
{
    for (const std::string& kind : procedural_kinds()) {
        CAPTURE(kind);
        const ScalarField field = procedural_field(spec_of(kind, {30, 40, 50}));
        CHECK(bool(field.gradient) == (kind != "speckles" && kind != "chirality"));
        if (!field.gradient) continue;
        std::mt19937 random(5);  // seed 5
        int smooth = 0;
        for (int i = 0; i < 3000; ++i) {
            const auto unit = [&] { return double(random()) / 4294967296.0; };
            const glm::dvec3 p = glm::dvec3(unit(), unit(), unit()) * glm::dvec3(30, 40, 50);
            const glm::dvec3 gradient = field.gradient(p);
            bool has_kink = false;
            glm::dvec3 derivative;
            for (int axis = 0; axis < 3; ++axis) {
                constexpr double STEP = 1e-4;
                glm::dvec3 step(0.0);
                step[axis] = STEP;
                const double before = (field.value(p) - field.value(p - step)) / STEP;
                const double after = (field.value(p + step) - field.value(p)) / STEP;
                derivative[axis] = 0.5 * (before + after);
                has_kink |= std::abs(before - after) > 0.3;
            }
            if (has_kink) continue;
            ++smooth;
            CHECK(glm::length(gradient - derivative) < 0.01);
        }
        CHECK(smooth > 2900);
    }
}

TEST_CASE("equal seeds give equal bits, on every machine")
{
    CHECK(mixed(1) == 1753845952u);
    CHECK(hash_of(1, 2, 3, 4) == 228479603u);
    const std::map<std::string, std::array<uint64_t, 2>> expected = {
        {"constant", {0x0443dd1f95f1a3a5u, 0x0443dd1f95f1a3a5u}},
        {"ramp", {0xc1319d706901b7a5u, 0xc1319d706901b7a5u}},
        {"sphere", {0x07870c9d3c19af11u, 0x07870c9d3c19af11u}},
        {"marschner_lobb", {0x0de6b2049fed1421u, 0x0de6b2049fed1421u}},
        {"checker", {0x474c3d59c85b9325u, 0x474c3d59c85b9325u}},
        {"chirality", {0x550fb1597c61d9b5u, 0x550fb1597c61d9b5u}},
        {"tubes", {0x6a2735119ccd6208u, 0x4828c26e9bd7e4cau}},
        {"speckles", {0x6d14ac6aca13fab1u, 0x59a64d8453bfab31u}},
        {"fog", {0x37426a1fc2b7e9c6u, 0xb51c329e0a43a29au}},
    };
    for (const auto& [kind, checksums] : expected) {
        CAPTURE(kind);
        CHECK(checksum(bytes_of_kind(kind, {40, 36, 33}, 1)) == checksums[0]);
        CHECK(checksum(bytes_of_kind(kind, {40, 36, 33}, 4000000000u)) == checksums[1]);
    }
    CHECK(expected.size() == procedural_kinds().size());
}

TEST_CASE("the closed forms are what they say")
{
    CHECK(bytes_of_kind("constant", Size3(3)) == std::vector<uint8_t>(27, 128));
    CHECK(bytes_of_kind("ramp", {6, 1, 1}) == std::vector<uint8_t>{0, 50, 100, 150, 200, 250});
    CHECK(bytes_of_kind("ramp", Size3(1)) == std::vector<uint8_t>{0});
    CHECK(bytes_of_kind("checker", Size3(2)) == std::vector<uint8_t>{50, 200, 200, 50, 200, 50, 50, 200});

    const ScalarField sphere = procedural_field(spec_of("sphere", {40, 60, 80}));
    const glm::dvec3 centre(20, 30, 40);
    const glm::dvec3 direction = glm::normalize(glm::dvec3(1, -2, 0.5));
    CHECK(sphere.value(centre) == 250.0);
    CHECK(sphere.value(centre + 14.0 * direction) == doctest::Approx(125.0));
    CHECK(sphere.value(centre + 15.0 * direction) == doctest::Approx(100.0));
    CHECK(sphere.value(glm::dvec3(0.0)) == 0.0);

    const ScalarField lobb = procedural_field(spec_of("marschner_lobb", Size3(64)));
    for (const glm::dvec3& p : {glm::dvec3(0.3, -0.2, 0.1), glm::dvec3(0.0), glm::dvec3(0.9, 0.9, -0.9)}) {
        const double pi = std::acos(-1.0);
        const double ring = std::cos(2.0 * pi * 6.0 * std::cos(0.5 * pi * std::hypot(p.x, p.y)));
        const double expected = (1.0 - std::sin(0.5 * pi * p.z) + 0.25 * (1.0 + ring)) / (2.0 * 1.25);
        CHECK(lobb.value((p + 1.0) * 32.0) == doctest::Approx(250.0 * expected).epsilon(1e-10));
    }
}

TEST_CASE("tubes are bright, few and in noise of 3 percent")
{
    const Size3 size(64, 64, 96);
    const std::vector<uint8_t> voxels = bytes_of_kind("tubes", size);
    double sum = 0.0;
    double squares = 0.0;
    int dark = 0;
    int bright = 0;
    for (const uint8_t voxel : voxels) {
        if (voxel < 60) {
            ++dark;
            sum += voxel;
            squares += double(voxel) * voxel;
        }
        bright += voxel > 195;
    }
    const double mean = sum / dark;
    CHECK(mean == doctest::Approx(40.0).epsilon(0.02));
    CHECK(std::sqrt(squares / dark - mean * mean) == doctest::Approx(5.4).epsilon(0.1));
    CHECK(bright > int(voxels.size()) / 100);
    CHECK(dark > int(voxels.size()) / 2);
    for (int64_t z = 0; z < size.z; ++z) {
        const auto first = voxels.begin() + z * size.x * size.y;
        CHECK(*std::max_element(first, first + size.x * size.y) > 195);
    }
    CHECK(bytes_of_kind("tubes", size, 2) != voxels);
    for (const Size3& odd : {Size3(1), Size3(2, 1, 3), Size3(100, 7, 65)}) {
        CHECK(bytes_of_kind("tubes", odd).size() == size_t(odd.x * odd.y * odd.z));
    }
}

TEST_CASE("no two speckles touch")
{
    const int64_t side = 64;
    const std::vector<uint8_t> voxels = bytes_of_kind("speckles", Size3(side));
    size_t at = 0;
    int balls = 0;
    int wrong = 0;
    for (int64_t z = 0; z < side; ++z) {
        for (int64_t y = 0; y < side; ++y) {
            for (int64_t x = 0; x < side; ++x, ++at) {
                const auto is_at_face = [](int64_t i) { return i % 8 == 0 || i % 8 == 7; };
                wrong += voxels[at] == 200 && (is_at_face(x) || is_at_face(y) || is_at_face(z));
                wrong += voxels[at] != 20 && voxels[at] != 200;
                balls += voxels[at] == 200;
            }
        }
    }
    CHECK(wrong == 0);
    CHECK(balls > 1000);
}

TEST_CASE("fog leaves nothing out and clears nothing")
{
    const std::vector<uint8_t> voxels = bytes_of_kind("fog", Size3(64));
    const auto [low, high] = std::minmax_element(voxels.begin(), voxels.end());
    CHECK(*low >= 60);
    CHECK(*high <= 160);
    CHECK(*high - *low > 50);
}

TEST_CASE("a volume of 2^32 voxels can be read at its far corner")
{
    const Size3 size(2048, 2048, 1024);
    for (const std::string& kind : procedural_kinds()) {
        CAPTURE(kind);
        const ProceduralSpec spec = spec_of(kind, size);
        const auto source = open_procedural(spec);
        CHECK(voxel_count(source->info()) == int64_t{1} << 32);
        const std::vector<uint8_t> corner = voxels_in<uint8_t>(*source, {size - Size3(3), size});
        CHECK(corner.back() == std::floor(procedural_field(spec).value(glm::dvec3(size) - 0.5) + 0.5));
        if (kind == "ramp") CHECK(corner.back() == 250);
        if (kind == "constant") CHECK(corner == std::vector<uint8_t>(27, 128));
    }
}

TEST_CASE("a procedural volume that cannot be is refused in words")
{
    CHECK(
        error_of([] { open_procedural(spec_of("tube", Size3(4))); }) ==
        "procedural volume is \"tube\"; expected one of constant, ramp, sphere, marschner_lobb, tubes, speckles, fog, "
        "checker, chirality");
    CHECK(error_of([] { procedural_field(spec_of("", Size3(4))); }) != "");
    CHECK(error_of([] {
              open_procedural(spec_of("fog", {4, 0, 4}));
          }) == "fog: size along y is 0; expected 1 to 1048576");
    ProceduralSpec flat = spec_of("fog", Size3(4));
    flat.spacing.z = 0.0;
    CHECK(error_of([&] { open_procedural(flat); }) == "fog: spacing along z is 0; expected a finite number above 0");
}

TEST_CASE("tubes are seen on every level of a volume in which they are thinner than its voxels")
{
    for (const int64_t side : {int64_t{1} << 16, int64_t{1} << 20}) {
        const std::unique_ptr<VolumeSource> tubes = open_procedural({.kind = "tubes", .size = Size3(side)});
        for (int level = tubes->levels() - 1; level >= tubes->levels() - 3; --level) {
            CAPTURE(level);
            const Size3 size = size_of_level(Size3(side), level);
            std::vector<std::byte> voxels(size_t(size.x * size.y));
            for (int64_t z = 0; z < size.z; z += 5) {
                tubes->read_level(level, {{0, 0, z}, {size.x, size.y, z + 1}}, voxels);
                // Eight from bottom to top; neighbours may touch on so coarse a level.
                CHECK(std::ranges::count_if(voxels, [](std::byte voxel) { return uint8_t(voxel) > 160; }) >= 8);
            }
        }
    }
}

TEST_CASE("where tubes are thicker than the voxels of a level, it holds the function at their centres")
{
    const ProceduralSpec spec{.kind = "tubes", .size = Size3(64), .seed = 3, .levels = 2};
    const ProceduralSpec bare{.kind = "speckles", .size = Size3(65, 64, 3), .seed = 3, .levels = 3};
    for (const auto& [of, level, wrong] : {std::tuple(bare, 1, 0), {bare, 2, 0}, {spec, 1, 2000}}) {
        const std::unique_ptr<VolumeSource> source = open_procedural(of);
        const ScalarField field = procedural_field(of);
        const Size3 size = size_of_level(of.size, level);
        std::vector<std::byte> voxels(size_t(size.x * size.y * size.z));
        source->read_level(level, {Size3(0), size}, voxels);
        int different = 0;
        for (int64_t i = 0; i < int64_t(voxels.size()); ++i) {
            const glm::dvec3 voxel(i % size.x, i / size.x % size.y, i / (size.x * size.y));
            const glm::dvec3 centre = glm::min(std::ldexp(1.0, level) * (voxel + 0.5), glm::dvec3(of.size));
            different +=
                int(uint8_t(voxels[size_t(i)])) != int(std::floor(std::clamp(field.value(centre), 0.0, 255.0) + 0.5));
        }
        CHECK(different <= wrong);  // the thinnest tubes are thicker
    }
}
