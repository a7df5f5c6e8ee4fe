// The definition of ambient occlusion, without a device: closed forms, for the sum over steps and for the few taps that
// approximate it. tests/gpu/occlusion_test.cpp tests whether the device computes these values.

#include "engine/passes/occlusion.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/reference/occlusion.h"

using namespace shvr;
using namespace shvr::reference;

namespace {

std::vector<glm::dvec3> directions(uint32_t count)
{
    return occlusion_directions(count);
}

OcclusionRays rays_of(double radius, uint32_t count)
{
    const OcclusionTaps taps = occlusion_taps(radius);
    OcclusionRays rays{
        .radius = taps.radius, .first = taps.first, .directions = directions(count), .exponent = taps.exponent};
    for (uint32_t i = 0; i < taps.taps.size(); ++i)
        rays.taps.push_back({double(taps.taps[i].distance), double(taps.taps[i].lift), double(taps.taps[i].stretch),
                             i < taps.end[0]   ? 0
                             : i < taps.end[1] ? 2
                                               : 4});
    return rays;
}

double by_steps(const FieldOpacity& opacity, uint32_t count, const OcclusionSide& side = {})
{
    return occlusion_by_steps(opacity, directions(count), 1.0, 2000, 0.0, 0.0, glm::dvec3(0.0), side);
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
    CHECK(std::abs(by_steps(plane, 256) - over_plane(h)) < AT_256_RAYS);
    CHECK(over_plane(h) == doctest::Approx(0.760944).epsilon(1e-6));
    CHECK(std::abs(by_steps(planes, 256) - (2.0 * over_plane(h) - 1.0)) < AT_256_RAYS);
    CHECK(std::abs(by_steps(ball, 256) - 0.925452) < 5e-3);  // its edge is a step in the integrand
    CHECK(std::abs(by_steps(shell, 256) - 0.3) < 1.0 / 2000 + 1e-9);
    CHECK(by_steps(half_space, 256, up) == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(std::abs(by_steps(wall, 256, up) - over_plane(h)) < AT_256_RAYS);
}

TEST_CASE("the error falls with more rays, faster than that of random ones")
{
    const auto plane = [&](const glm::dvec3& p) { return p.x + 0.3 * p.y < -0.2 * std::hypot(1.0, 0.3) ? 1.0 : 0.0; };
    const double few = std::abs(by_steps(plane, 32) - over_plane(0.2));
    const double many = std::abs(by_steps(plane, 1024) - over_plane(0.2));
    CHECK(few < 2e-2);
    CHECK(many < 1e-3);
}

TEST_CASE("an even medium has the closed form: over steps exactly, with six looks within 0.03")
{
    for (const double a : {0.001, 0.01, 0.05, 0.2}) {
        CAPTURE(a);
        constexpr int STEPS = 16;
        const double discrete = (1.0 - std::pow(1.0 - a, STEPS)) / (STEPS * a);
        const FieldOpacity even = [&](const glm::dvec3&) { return a; };
        CHECK(std::abs(occlusion_by_steps(even, directions(8), STEPS, STEPS, 0.0, 0.0, glm::dvec3(0.0), {}) -
                       discrete) < 1e-12);
        const double extinction = -std::log1p(-a), free = rays_of(16.0, 1).first;
        const double expected = (free - std::expm1(-extinction * (16.0 - free)) / extinction) / 16.0;
        const double found = occlusion_by_taps([&](const glm::ivec3&) { return a; }, rays_of(16.0, 8), {0, 0, 0}, {});
        // Each stretch is a trapezium, which transmits slightly more.
        CHECK(std::abs(found - expected) < (a < 0.1 ? 0.01 : 0.03));
    }
}

TEST_CASE("six looks see planes, gaps and walls within a few hundredths of the closed form")
{
    const double radius = 16.0;
    const auto compare = [&](const char* what, const VoxelOpacity& opacity, const OcclusionSide& side, double expected,
                             double bound = 0.05) {
        CAPTURE(what);
        const double found = occlusion_by_taps(opacity, rays_of(radius, 32), {1, 2, 3}, side);
        CAPTURE(found);
        CAPTURE(expected);
        CHECK(std::abs(found - expected) < bound);
    };
    const OcclusionSide up{{0.0, 0.0, 1.0}, 1.0};
    compare(
        "plane", [](const glm::ivec3& v) { return v.z < 0 ? 1.0 : 0.0; }, {}, over_plane(3.5 / radius));
    compare(
        "gap", [](const glm::ivec3& v) { return v.z < 0 || v.z > 6 ? 1.0 : 0.0; }, {},
        2.0 * over_plane(3.5 / radius) - 1.0, 0.065);  // the error of two planes
    compare(
        "half space", [](const glm::ivec3& v) { return v.z <= 3 ? 1.0 : 0.0; }, up, 1.0);
    compare(
        "floor and wall", [](const glm::ivec3& v) { return v.z <= 3 || v.x > 5 ? 1.0 : 0.0; }, up,
        over_plane(4.5 / radius));
    // Rays of equal length all end in the same stretch, of four units: half of it is the maximum error.
    compare(
        "shell", [](const glm::ivec3& v) { return glm::length(glm::dvec3(v) - glm::dvec3(1, 2, 3)) > 6.0 ? 1.0 : 0.0; },
        {}, 6.5 / radius, 2.0 / radius);
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
    const OcclusionTaps taps = occlusion_taps(16.0);
    CHECK(occlusion_by_taps(everywhere, rays_of(16.0, 64), {0, 0, 0}, {}) ==
          doctest::Approx((taps.first + 0.5 * taps.near_stretch) / 16).epsilon(1e-6));
}

TEST_CASE("looks cover the radius without gaps, within the bricks that are at hand")
{
    for (double radius = 0.1; radius <= OCCLUSION_MAX_RADIUS; radius += 0.37) {
        CAPTURE(radius);
        const OcclusionTaps taps = occlusion_taps(radius);
        CHECK(taps.taps.size() <= gpu::OCCLUSION_MAX_TAPS);
        CHECK(taps.end[2] == taps.taps.size());
        double sum = taps.first;
        for (const gpu::OcclusionTap& tap : taps.taps) {
            CHECK(double(tap.stretch) > 0.0);
            CHECK(double(tap.distance) <= std::max(radius, 1.0));
            CHECK(double(tap.distance) + double(tap.lift) + 1.0 <= gpu::BRICK_SIZE * occlusion_reach(radius));
            sum += double(tap.stretch);
        }
        CHECK(sum == doctest::Approx(radius).epsilon(1e-6));
        CHECK(occlusion_reach(radius) <= gpu::OCCLUSION_REACH);
    }
}
