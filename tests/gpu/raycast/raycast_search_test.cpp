// The worst inputs, looked for: random ones first, then steps from the worst so far, shorter and shorter. What other
// tests try are inputs that someone thought of.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Numbers from 0 to 1 that a test makes an input of.
using Place = std::array<double, 8>;

constexpr int RANDOM = 60, CLIMBING = 60;

/// Calls `error_at` at RANDOM places and then near the worst one found, in CLIMBING steps that grow shorter.
void search(uint32_t seed, const std::function<double(const Place&)>& error_at)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    Place worst{};
    double most = -1.0;
    for (int i = 0; i < RANDOM + CLIMBING; ++i) {
        Place place = worst;
        const double reach = 0.3 * std::pow(0.93, i - RANDOM);
        for (double& value : place)
            value = i < RANDOM ? unit(random) : std::clamp(value + reach * normal(random), 0.0, 1.0);
        const double error = error_at(place);
        if (error > most) most = error, worst = place;
    }
}

glm::dvec3 direction_of(double a, double b)
{
    const double z = 2.0 * a - 1.0, angle = 2.0 * M_PI * b, across = std::sqrt(1.0 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "search: rays of any direction, distance, step and opacity are those of the reference")
{
    load(noise_volume({41, 37, 33}, 5));
    search(1, [&](const Place& at) {
        const double step = std::exp2(4.0 * at[2] - 3.0), opacity = 0.01 + 0.14 * at[3];
        Session session = plain_session(busy_points(opacity), {16, 12});
        session.render.step_voxels = step;
        const glm::dvec3 direction = direction_of(at[0], at[1]);
        Camera camera = camera_along(volume(), direction, 20.0 + 60.0 * at[4]);
        const bool is_perspective = at[5] > 0.5;
        const double distance = 30.0 * std::pow(1000.0, at[6]);
        if (is_perspective)
            camera = perspective(camera.target - distance * direction, camera.target, 5.0 + 60.0 * at[7]);
        CAPTURE(direction.x);
        CAPTURE(direction.y);
        CAPTURE(direction.z);
        CAPTURE(step);
        CAPTURE(opacity);
        CAPTURE(is_perspective);
        CAPTURE(distance);
        const double found = error(session, camera);
        // Rays that graze an edge enter 4e-6 / angle off: more than the 2e-5 of inputs that someone thought of.
        check_below("discrete", found, 2e-4);
        return found;
    });
}

TEST_CASE_FIXTURE(OnDevice, "search: slabs of any opacity, step and length are as opaque as their closed form says")
{
    load(constant_volume({40, 4, 4}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    search(2, [&](const Place& at) {
        const double step = std::exp2(5.0 * at[0] - 3.0), opacity = std::pow(at[1], 3.0) * 0.9999;
        const double begin = 8.0 * at[2], length = 30.0 * at[3] * at[3] + 0.001;
        CAPTURE(step);
        CAPTURE(opacity);
        CAPTURE(begin);
        CAPTURE(length);
        Session session = plain_session(uniform_points(WHITE, opacity), {4, 4});
        session.render.background = glm::dvec4(0.0);
        session.render.step_voxels = step;
        session.cut = {.lower = {begin, 0.0, 0.0}, .upper = {begin + length, 4.0, 4.0}};
        const double seen = opacity_of_depth(length * depth_of_opacity(opacity));
        const double found =
            worst_difference(pixels_of(draw(session, camera)), Pixels(16, glm::dvec4(seen, seen, seen, seen)));
        check_below("closed form", found, 2e-5);
        return found;
    });
}

TEST_CASE_FIXTURE(OnDevice, "search: shading of noise under any light is the reference's")
{
    load(noise_volume({24, 24, 24}, 8));
    search(3, [&](const Place& at) {
        Session session = plain_session(busy_points(0.02 + 0.1 * at[3]), {12, 12});
        session.light.shaded = true;
        session.light.ambient = at[4];
        session.light.specular = at[5];
        session.light.shininess = 1.0 + 127.0 * at[6];
        session.light.direction = direction_of(at[7], at[2]);
        const glm::dvec3 direction = direction_of(at[0], at[1]);
        CAPTURE(direction.x);
        CAPTURE(direction.y);
        CAPTURE(direction.z);
        CAPTURE(session.light.specular);
        CAPTURE(session.light.shininess);
        const double found = error(session, camera_along(volume(), direction, 40.0));
        check_below("discrete", found, 2e-4);
        return found;
    });
}
