// The definition of ambient occlusion, without a device: closed forms, for the sum over steps and for the few taps that
// approximate it. tests/gpu/occlusion/occlusion_test.cpp tests whether the device computes these values.

#include "engine/passes/occlusion.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/reference/occlusion.h"
#include "tests/support/bounds.h"

using namespace shvr;
using namespace shvr::reference;

namespace {

OcclusionRays rays_of(double radius, uint32_t count)
{
    const OcclusionTaps taps = occlusion_taps(radius);
    OcclusionRays rays{.asked = {.radius = radius},
                       .count = count,
                       .first = taps.first,
                       .taps = {},
                       .near_stretch = std::max(taps.near_stretch, 1e-3),
                       .stretch_of_2 = taps.stretches[0],
                       .stretch_of_4 = taps.stretches[1]};
    for (uint32_t i = 0; i < taps.taps.size(); ++i)
        rays.taps.push_back({double(taps.taps[i].distance), double(taps.taps[i].stretch),
                             i < taps.end[0]   ? 1
                             : i < taps.end[1] ? 2
                                               : 4});
    return rays;
}

double by_steps(const FieldOpacity& opacity, uint32_t count, const OcclusionSide& side = {})
{
    return occlusion_by_steps(opacity, occlusion_directions(count, side, false), 1.0, 2000, glm::dvec3(0.0));
}

/// The light at height `h` over an opaque plane, in radii, with light from all sides.
double over_plane(double h)
{
    return 0.5 + 0.5 * h * (1.0 + std::log(1.0 / h));
}

constexpr double AT_256_RAYS = 3e-3;

}  // namespace

TEST_CASE("light from 256 sides meets the closed forms")
{
    const double h = 0.2;
    const auto plane = [&](const glm::dvec3& p) { return p.z < -h ? 1.0 : 0.0; };
    const auto planes = [&](const glm::dvec3& p) { return std::abs(p.z) > h ? 1.0 : 0.0; };
    const auto ball = [&](const glm::dvec3& p) { return glm::length(p - glm::dvec3(0.0, 0.5, 0.0)) < 0.3 ? 1.0 : 0.0; };
    const auto shell = [&](const glm::dvec3& p) { return glm::length(p) >= 0.3 ? 1.0 : 0.0; };
    const auto half_space = [&](const glm::dvec3& p) { return p.z < -1e-9 ? 1.0 : 0.0; };
    const auto wall = [&](const glm::dvec3& p) { return p.z < -1e-9 || p.x > h ? 1.0 : 0.0; };
    const OcclusionSide up{{0.0, 0.0, 1.0}, 1.0};
    CHECK(by_steps([](const glm::dvec3&) { return 0.0; }, 256) == doctest::Approx(1.0).epsilon(1e-9));
    test::check_below("over a plane", std::abs(by_steps(plane, 256) - over_plane(h)), AT_256_RAYS);
    CHECK(over_plane(h) == doctest::Approx(0.760944).epsilon(1e-6));
    test::check_below("between planes", std::abs(by_steps(planes, 256) - (2.0 * over_plane(h) - 1.0)), AT_256_RAYS);
    test::check_below("beside a ball", std::abs(by_steps(ball, 256) - 0.925452),
                      5e-3);  // its edge is a step in the integrand
    test::check_below("in a shell", std::abs(by_steps(shell, 256) - 0.3), 1.0 / 2000 + 1e-9);
    CHECK(by_steps(half_space, 256, up) == doctest::Approx(1.0).epsilon(1e-9));
    test::check_below("before a wall", std::abs(by_steps(wall, 256, up) - over_plane(h)), AT_256_RAYS);
}

TEST_CASE("the error falls with more rays, faster than that of random ones")
{
    const auto plane = [&](const glm::dvec3& p) { return p.x + 0.3 * p.y < -0.2 * std::hypot(1.0, 0.3) ? 1.0 : 0.0; };
    const double few = std::abs(by_steps(plane, 32) - over_plane(0.2));
    const double many = std::abs(by_steps(plane, 1024) - over_plane(0.2));
    test::check_below("32 rays", few, 2e-2);
    test::check_below("1024 rays", many, 1e-3);
}

TEST_CASE("an even medium has the closed form: over steps exactly, by its definition and with eight samples nearly")
{
    for (const double a : {0.001, 0.01, 0.05, 0.2, 0.5}) {
        CAPTURE(a);
        constexpr int STEPS = 16;
        const double discrete = (1.0 - std::pow(1.0 - a, STEPS)) / (STEPS * a);
        const FieldOpacity even = [&](const glm::dvec3&) { return a; };
        CHECK(std::abs(occlusion_by_steps(even, occlusion_directions(8), STEPS, STEPS, glm::dvec3(0.0)) - discrete) <
              1e-12);
        const double extinction = -std::log1p(-a), expected = -std::expm1(-extinction * 16.0) / (extinction * 16.0);
        test::check_below("definition", std::abs(occlusion_defined(even, {}, {0, 0, 0}, {}, 8, 1000) - expected), 1e-5);
        const double found = occlusion_by_taps([&](const glm::ivec3&) { return a; }, rays_of(16.0, 8), {0, 0, 0}, {});
        test::check_below("eight samples", std::abs(found - expected), 0.012);
    }
}

TEST_CASE("the definition meets the closed forms of sharp surfaces, wherever in the edge a voxel is")
{
    // The surface is at height 0; voxels lie around it, and rays begin 0.07 units above it.
    const OcclusionSide up{{0.0, 0.0, 1.0}, 1.0};
    for (const double z : {0.0, 0.3, 0.8}) {
        CAPTURE(z);
        const auto floor = [&](const glm::dvec3& p) { return p.z < z ? 1.0 : 0.0; };
        const auto wall = [&](const glm::dvec3& p) { return p.z < z || p.x > 5.5 ? 1.0 : 0.0; };
        const auto slit = [&](const glm::dvec3& p) { return p.z < z || p.z > z + 4.0 ? 1.0 : 0.0; };
        for (const int voxel : {-1, 0}) {
            CAPTURE(voxel);
            const auto at = [&](const FieldOpacity& opacity, bool full_sphere = false) {
                return occlusion_defined(opacity, {.full_sphere = full_sphere}, {0, 0, voxel}, up, 512, 256);
            };
            const double h = 0.07 / 16.0;
            CHECK(std::abs(at(floor) - 1.0) < 0.005);
            CHECK(std::abs(at(floor, true) - over_plane(h)) < 0.01);
            CHECK(std::abs(over_plane(h) - 0.5) < 0.03);
            CHECK(std::abs(at(wall) - over_plane(5.0 / 16.0)) < 0.01);
            CHECK(std::abs(at(slit) - (2.0 * over_plane(4.0 / 16.0) - 1.0)) < 0.02);
        }
    }
    // In a hollow: chords.
    for (const double r : {4.0, 6.0}) {
        const auto hollow = [&](const glm::dvec3& p) {
            return glm::length(p - glm::dvec3(0.5, 0.5, 0.5 + r)) > r ? 1.0 : 0.0;
        };
        CHECK(std::abs(occlusion_defined(hollow, {}, {0, 0, 0}, up, 512, 256) - r / 16.0) < 0.03);
    }
}

TEST_CASE("eight samples see planes, gaps and walls within a few hundredths of the closed form")
{
    const double radius = 16.0;
    const auto compare = [&](const char* what, const VoxelOpacity& opacity, const OcclusionSide& side, double expected,
                             double bound) {
        CAPTURE(what);
        const double found = occlusion_by_taps(opacity, rays_of(radius, 64), {1, 2, 3}, side);
        CAPTURE(found);
        CAPTURE(expected);
        CHECK(std::abs(found - expected) < bound);
    };
    const OcclusionSide up{{0.0, 0.0, 1.0}, 1.0};
    compare(
        "plane", [](const glm::ivec3& v) { return v.z < 0 ? 1.0 : 0.0; }, {}, over_plane(3.5 / radius), 0.03);
    compare(
        "gap", [](const glm::ivec3& v) { return v.z < 0 || v.z > 6 ? 1.0 : 0.0; }, {},
        2.0 * over_plane(3.5 / radius) - 1.0, 0.05);
    compare(
        "half space", [](const glm::ivec3& v) { return v.z <= 3 ? 1.0 : 0.0; }, up, 1.0, 0.01);
    compare(
        "floor and wall", [](const glm::ivec3& v) { return v.z <= 3 || v.x > 5 ? 1.0 : 0.0; }, up,
        over_plane(4.5 / radius), 0.03);
    // A wall of one voxel stops what crosses it, whichever cells it is in. Planes fit one badly whose opacity is all or
    // nothing; as densities have walls, tests/gpu/occlusion/occlusion_light_test.cpp has a sheet on a floor.
    for (int x = 5; x < 13; ++x)
        compare(
            "floor and thin wall", [&](const glm::ivec3& v) { return v.z <= 3 || v.x == x ? 1.0 : 0.0; }, up,
            over_plane((x - 1.5) / radius), 0.095);
}

TEST_CASE("a voxel does not shadow itself, and a radius below one voxel sees nothing")
{
    const VoxelOpacity alone = [](const glm::ivec3& v) { return v == glm::ivec3(0) ? 1.0 : 0.0; };
    for (const double radius : {0.3, 0.9, 1.0, 2.0, 3.7, 7.0}) {
        CAPTURE(radius);
        CHECK(occlusion_by_taps(alone, rays_of(radius, 64), {0, 0, 0}, {}) == doctest::Approx(1.0).epsilon(1e-6));
    }
    const VoxelOpacity everywhere = [](const glm::ivec3&) { return 1.0; };
    CHECK(occlusion_by_taps(everywhere, rays_of(0.9, 64), {0, 0, 0}, {}) == doctest::Approx(1.0).epsilon(1e-6));
    CHECK(occlusion_by_taps(everywhere, rays_of(16.0, 64), {0, 0, 0}, {}) == 0.0);
    const FieldOpacity ball = [](const glm::dvec3& p) { return glm::length(p - 0.5) < 0.49 ? 1.0 : 0.0; };
    CHECK(occlusion_defined(ball, {}, {0, 0, 0}, {}, 64, 256) > 0.99);
}

TEST_CASE("looks cover the radius without gaps, within the bricks that are at hand")
{
    for (double radius = 0.1; radius <= OCCLUSION_MAX_RADIUS; radius += 0.37) {
        CAPTURE(radius);
        const OcclusionTaps taps = occlusion_taps(radius);
        CHECK(taps.end[0] <= gpu::OCCLUSION_NEAR_TAPS);
        CHECK(taps.end[1] - taps.end[0] <= gpu::OCCLUSION_TAPS_2);
        CHECK(taps.end[2] - taps.end[1] <= gpu::OCCLUSION_TAPS_4);
        CHECK(taps.end[2] == taps.taps.size());
        double sum = taps.first;
        for (const gpu::OcclusionTap& tap : taps.taps) {
            CHECK(double(tap.stretch) > 0.0);
            CHECK(double(tap.distance) <= std::max(radius, 1.0));
            CHECK(double(tap.distance) + 2.6 <= gpu::BRICK_SIZE * occlusion_reach(radius));
            sum += double(tap.stretch);
        }
        CHECK(sum == doctest::Approx(radius).epsilon(1e-6));
        CHECK(occlusion_reach(radius) <= gpu::OCCLUSION_REACH);
    }
}
