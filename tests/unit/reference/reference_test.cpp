// The reference renderer is itself checked: against closed forms, and against brute force where none exists.

#include "tests/reference/render.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "tests/reference/brute_force.h"
#include "tests/reference/cubic.h"
#include "tests/reference/field.h"
#include "tests/reference/samples.h"
#include "tests/support/bounds.h"

namespace {

using namespace shvr::reference;
using shvr::test::check_below;

const glm::dvec3 ORANGE(1.0, 0.5, 0.25);

Scene constant_scene(const glm::ivec3& size, double opacity)
{
    Scene scene = scene_of(size, [](glm::dvec3) { return 0.5; });
    scene.points = {{0.0, ORANGE, opacity}, {1.0, ORANGE, opacity}};
    return scene;
}

// Three tones, a step and a gap; no opacity reaches 1.
std::vector<ControlPoint> busy_points()
{
    return {{0.1, {1, 0, 0}, 0.0},  {0.3, {0, 1, 0}, 0.2}, {0.5, {0, 0, 1}, 0.0},
            {0.6, {1, 1, 0}, 0.05}, {0.6, {0, 1, 1}, 0.4}, {0.9, {1, 0, 1}, 0.7}};
}

double opacity_of(double depth)
{
    return -std::expm1(-depth);
}

double extinction(double opacity)
{
    return -std::log1p(-opacity);
}

Ray along_x(double y, double z)
{
    return {.origin = {-5.0, y, z}, .direction = {1.0, 0.0, 0.0}};
}

double largest_difference(const glm::dvec4& a, const glm::dvec4& b)
{
    const glm::dvec4 d = glm::abs(a - b);
    return std::max({d.x, d.y, d.z, d.w});
}

double worst_against_brute_force(const Scene& scene, int rays, int samples, uint32_t seed)
{
    std::mt19937 random(seed);
    double worst = 0.0;
    for (int i = 0; i < rays; ++i) {
        const Ray ray = random_ray(scene, random);
        const std::optional<Interval> inside = clip_to_box(ray, glm::dvec3(0.0), glm::dvec3(scene.size));
        REQUIRE(inside.has_value());
        const glm::dvec4 brute = brute_force(scene, ray, inside->lower, inside->upper, samples);
        worst = std::max(worst, largest_difference(integrate_exact(scene, ray), brute));
    }
    return worst;
}

// Every other way of cutting a ray must give the same picture: `parts` times the ray, each part clipped by t.
double worst_against_parts(const Scene& scene, int rays, int parts, uint32_t seed)
{
    std::mt19937 random(seed);
    double worst = 0.0;
    for (int i = 0; i < rays; ++i) {
        const Ray ray = random_ray(scene, random);
        const std::optional<Interval> inside = clip_to_box(ray, glm::dvec3(0.0), glm::dvec3(scene.size));
        REQUIRE(inside.has_value());
        const double width = (inside->upper - inside->lower) / parts;
        glm::dvec4 composed(0.0);
        for (int k = 0; k < parts; ++k) {
            Ray part = ray;
            part.t_min = inside->lower + k * width;
            part.t_max = inside->lower + (k + 1) * width;
            composed += (1.0 - composed.a) * integrate_exact(scene, part);
        }
        worst = std::max(worst, largest_difference(integrate_exact(scene, ray), composed));
    }
    return worst;
}

}  // namespace

TEST_CASE("a homogeneous slab absorbs 1 - exp(-sigma L)")
{
    for (const auto& [depth, printed] : {std::pair(0.01, 0.009950166), {1.0, 0.632120559}, {5.0, 0.993262053}}) {
        const Scene scene = constant_scene({10, 4, 4}, opacity_of(depth / 10.0));
        const glm::dvec4 expected(ORANGE * opacity_of(depth), opacity_of(depth));
        CHECK(std::abs(expected.a - printed) < 5e-10);
        check_below("exact", largest_difference(integrate_exact(scene, along_x(2.2, 1.7)), expected), 1e-14);
        const glm::dvec4 stepped = integrate_discrete(scene, along_x(2.2, 1.7), {.step = 0.3});
        check_below("discrete, with a rest", largest_difference(stepped, expected), 1e-14);
    }
}

TEST_CASE("length is counted along the ray, in reference voxels")
{
    // A slab one voxel thick and 4 units per voxel, hit at an angle; the reference voxel is 0.5 units.
    Scene scene = constant_scene({40, 40, 1}, 0.02);
    scene.spacing = {0.5, 1.0, 4.0};
    const double cosine = 0.25;
    const glm::dvec3 physical(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
    const glm::dvec3 direction = physical / scene.spacing;
    const Ray ray{.origin = glm::dvec3(4.0, 20.3, 0.0) - 2.0 * direction, .direction = direction};
    const double expected = opacity_of(extinction(0.02) * (4.0 / cosine) / 0.5);
    check_below("angle", std::abs(integrate_exact(scene, ray).a - expected), 1e-14);
    check_below("angle, discrete", std::abs(integrate_discrete(scene, ray, {.step = 0.7}).a - expected), 1e-14);
}

TEST_CASE("two materials composite front over back")
{
    // Thicknesses .7 and 1.3 of the table: the cut box trims a two-voxel volume whose halves carry different labels.
    Scene scene = constant_scene({2, 1, 1}, 0.5);
    scene.labels = {1, 2};
    scene.groups[1] = {.color = glm::dvec3(1.0), .opacity = opacity_of(0.7)};
    scene.groups[2] = {.color = glm::dvec3(0.25), .opacity = opacity_of(1.3)};
    const glm::dvec4 light = integrate_exact(scene, along_x(0.5, 0.5));
    CHECK(std::abs(light.r - 0.593727201) < 5e-10);
    CHECK(std::abs(light.a - 0.864664717) < 5e-10);
    const double expected = opacity_of(0.7) + std::exp(-0.7) * 0.25 * opacity_of(1.3);
    check_below("two materials", std::abs(light.r - expected), 1e-14);
}

TEST_CASE("a linear ramp of opacity has the closed depth ((1-a) ln(1-a) + a) / k")
{
    // Density rises from 0 at x = 0.5 to 1 at x = 10.5; opacity follows up to `top` at density 1.
    for (const double top : {1e-3, 0.5, 0.999, 1.0}) {
        Scene scene = scene_of({11, 2, 2}, [](glm::dvec3 p) { return (p.x - 0.5) / 10.0; });
        scene.points = {{0.0, ORANGE, 0.0}, {1.0, ORANGE, top}};
        scene.cut_max.x = 10.5;
        const double left = 1.0 - top;
        const double depth = ((left > 0.0 ? left * std::log(left) : 0.0) + top) / (top / 10.0);
        const glm::dvec4 light = integrate_exact(scene, along_x(1.0, 1.0));
        if (top < 1.0) {
            check_below("ramp", largest_difference(light, glm::dvec4(ORANGE, 1.0) * opacity_of(depth)), 1e-12);
        } else {
            CHECK(light.a == 1.0);  // ends on an opaque surface
            check_below("ramp to an opaque surface", largest_difference(light, glm::dvec4(ORANGE, 1.0)), 1e-12);
        }
    }
}

TEST_CASE("the singular extinction before an opaque surface is integrated")
{
    // Orange up to opacity 1, where a step of colour makes the surface blue: its share is exp(-depth), depth = 10.
    Scene scene = scene_of({21, 2, 2}, [](glm::dvec3 p) { return (p.x - 0.5) / 20.0; });
    scene.points = {{0.0, ORANGE, 0.0}, {0.5, ORANGE, 1.0}, {0.5, {0, 0, 1}, 1.0}, {1.0, {0, 1, 0}, 1.0}};
    const glm::dvec4 light = integrate_exact(scene, along_x(1.0, 1.0));
    const glm::dvec3 expected = opacity_of(10.0) * ORANGE + std::exp(-10.0) * glm::dvec3(0, 0, 1);
    CHECK(light.a == 1.0);
    check_below("opaque surface", largest_difference(light, glm::dvec4(expected, 1.0)), 1e-12);
}

TEST_CASE("what opacity 0 covers changes no bit of the background")
{
    Scene scene = noise_scene({8, 9, 7}, 1);
    scene.background = {0.1, 1.0 / 3.0, 0.7};
    scene.points = {{0.0, ORANGE, 0.0}, {1.0, ORANGE, 0.0}};
    scene.shading = Shading{};
    std::mt19937 random(2);
    for (int i = 0; i < 50; ++i) {
        const Ray ray = random_ray(scene, random);
        for (const glm::dvec4& light : {integrate_exact(scene, ray), integrate_discrete(scene, ray)}) {
            CHECK(light == glm::dvec4(0.0));
            CHECK(over_background(light, scene) == glm::dvec4(scene.background, 0.0));
        }
    }
}

TEST_CASE("nothing behind opacity 1 counts")
{
    Scene scene = scene_of({10, 3, 3}, [](glm::dvec3 p) { return p.x < 5.0 ? 0.25 : 0.75; });
    scene.points = {{0.0, ORANGE, 0.1}, {0.6, ORANGE, 0.1}, {0.6, {0, 0, 1}, 1.0}, {1.0, {0, 0, 1}, 1.0}};
    const glm::dvec4 light = integrate_exact(scene, along_x(1.5, 1.5));
    // Density passes 0.6 at x = 4.5 + 0.7.
    const double in_front = std::exp(-extinction(0.1) * 5.2);
    CHECK(light.a == 1.0);
    const glm::dvec3 expected = ORANGE * (1.0 - in_front) + in_front * glm::dvec3(0, 0, 1);
    check_below("surface", largest_difference(light, glm::dvec4(expected, 1.0)), 1e-13);

    Scene other_back = scene;
    for (size_t i = 0; i < other_back.density.size(); ++i) {
        if (i % 10 > 5) other_back.density[i] = 0.1;
    }
    other_back.background = glm::dvec3(7.0);
    const glm::dvec4 seen = over_background(integrate_exact(other_back, along_x(1.5, 1.5)), other_back);
    CHECK(seen == over_background(light, scene));
    const glm::dvec4 stepped = integrate_discrete(scene, along_x(1.5, 1.5), {.step = 0.25});
    CHECK(stepped == integrate_discrete(other_back, along_x(1.5, 1.5), {.step = 0.25}));
    CHECK(stepped.a == 1.0);
}

TEST_CASE("a volume that holds only the last control point's density is drawn")
{
    // Every density below 0.7 has opacity 0, and 0.7 itself 0.3.
    Scene scene = scene_of({6, 6, 6}, [](glm::dvec3) { return 0.7; });
    scene.points = {{0.5, ORANGE, 0.0}, {0.7, ORANGE, 0.0}, {0.7, ORANGE, 0.3}};
    const Ray ray{.origin = {-3.0, 1.1, 0.3}, .direction = {0.9, 0.31, 0.47}};
    const std::optional<Interval> inside = clip_to_box(ray, glm::dvec3(0.0), glm::dvec3(6.0));
    const double length = (inside->upper - inside->lower) * glm::length(ray.direction);
    check_below("last point", std::abs(integrate_exact(scene, ray).a - opacity_of(extinction(0.3) * length)), 1e-14);
}

TEST_CASE("fewer than two control points draw nothing, and order does not matter")
{
    Scene scene = noise_scene({5, 5, 5}, 4);
    scene.points = {};
    CHECK(integrate_exact(scene, along_x(2.0, 2.0)) == glm::dvec4(0.0));
    scene.points = {{0.5, ORANGE, 1.0}};
    CHECK(integrate_exact(scene, along_x(2.0, 2.0)) == glm::dvec4(0.0));
    CHECK(integrate_discrete(scene, along_x(2.0, 2.0), {.table_entries = 16}) == glm::dvec4(0.0));
    scene.points = busy_points();
    const glm::dvec4 sorted = integrate_exact(scene, along_x(2.0, 2.0));
    std::rotate(scene.points.begin(), scene.points.begin() + 3, scene.points.end());
    std::swap(scene.points[2], scene.points[5]);
    CHECK(integrate_exact(scene, along_x(2.0, 2.0)) == sorted);
}

TEST_CASE("a ray in a face is inside, whatever the sign of its zeros")
{
    const glm::dvec3 lower(0.0), upper(4.0, 5.0, 6.0);
    for (const double y : {0.0, 5.0}) {
        for (const double zero : {0.0, -0.0}) {
            const auto inside = clip_to_box({.origin = {-1, y, 3}, .direction = {2, zero, zero}}, lower, upper);
            REQUIRE(inside.has_value());
            CHECK(inside->lower == 0.5);
            CHECK(inside->upper == 2.5);
        }
    }
    CHECK_FALSE(clip_to_box({.origin = {-1, 5.0000001, 3}, .direction = {2, 0, 0}}, lower, upper).has_value());
    CHECK_FALSE(clip_to_box({.origin = {5, 1, 3}, .direction = {2, 0, 0}}, lower, upper).has_value());
    CHECK_FALSE(clip_to_box({.origin = {-1, 1, 1}, .direction = {1, 0, 0}, .t_max = 0.5}, lower, upper).has_value());
    CHECK_FALSE(clip_to_box({.origin = {1, 1, 1}, .direction = {1, 0, 0}}, upper, lower).has_value());
    const auto grazing = clip_to_box({.origin = {0, 0, 0}, .direction = {1, 4.9e-324, -0.0}}, lower, upper);
    REQUIRE(grazing.has_value());
    CHECK(grazing->upper == 4.0);

    // Through the face between voxels and along the outer faces, the field is that of the voxels beside it.
    Scene scene = scene_of({6, 4, 4}, [](glm::dvec3 p) { return p.y / 4.0; });
    scene.points = {{0.0, ORANGE, 0.0}, {1.0, ORANGE, 0.8}};
    for (const auto& [y, density] : {std::pair(0.0, 0.125), {2.0, 0.5}, {4.0, 0.875}}) {
        const double expected = opacity_of(6.0 * extinction(0.8 * density));
        check_below("in a face", std::abs(integrate_exact(scene, along_x(y, 2.0)).a - expected), 1e-14);
        Ray backwards = along_x(y, 4.0);
        backwards.origin.x = 11.0;
        backwards.direction = {-1.0, -0.0, 0.0};
        check_below("backwards", std::abs(integrate_exact(scene, backwards).a - expected), 1e-14);
    }
}

TEST_CASE("a camera inside sees what lies before it, and a ray of no length sees nothing")
{
    const Scene scene = constant_scene({16, 4, 4}, 0.1);
    Ray ray = along_x(2.0, 2.0);
    ray.origin.x = 9.75;
    check_below("inside", std::abs(integrate_exact(scene, ray).a - opacity_of(6.25 * extinction(0.1))), 1e-14);
    ray.t_max = 2.0;
    check_below("clipped", std::abs(integrate_exact(scene, ray).a - opacity_of(2.0 * extinction(0.1))), 1e-14);
    ray.t_max = 0.0;
    CHECK(integrate_exact(scene, ray) == glm::dvec4(0.0));
    CHECK(integrate_discrete(scene, ray) == glm::dvec4(0.0));
    ray.t_max = -1.0;
    CHECK(integrate_exact(scene, ray) == glm::dvec4(0.0));
    ray = {.origin = {3.0, 2.0, 2.0}, .direction = glm::dvec3(0.0)};
    CHECK(integrate_exact(scene, ray) == glm::dvec4(0.0));
    CHECK(integrate_discrete(scene, ray) == glm::dvec4(0.0));
}

TEST_CASE("a sliding cut box takes away exactly what it covers")
{
    Scene scene = constant_scene({16, 4, 4}, 0.1);
    double worst = 0.0, worst_discrete = 0.0, last = 2.0;
    bool is_monotone = true;
    for (int k = 0; k <= 16 * 64; ++k) {
        scene.cut_min.x = k / 64.0;
        const double expected = opacity_of(extinction(0.1) * (16.0 - k / 64.0));
        const double exact = integrate_exact(scene, along_x(1.3, 2.0)).a;
        const double stepped = integrate_discrete(scene, along_x(1.3, 2.0), {.step = 0.3}).a;
        is_monotone = is_monotone && exact < last;
        last = exact;
        worst = std::max(worst, std::abs(exact - expected));
        worst_discrete = std::max(worst_discrete, std::abs(stepped - expected));
    }
    CHECK(is_monotone);
    CHECK(last == 0.0);
    check_below("sliding", worst, 1e-13);
    check_below("sliding, discrete", worst_discrete, 1e-13);
}

TEST_CASE("cubics are split where they turn and where they cross a level")
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const std::vector<double> levels{0.1, 0.2, 0.5, 0.50001, 0.9};
    double worst_value = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const std::array<double, 4> values{uniform(random), uniform(random), uniform(random), uniform(random)};
        const Cubic cubic = cubic_through(values);
        for (size_t k = 0; k < 4; ++k) {
            worst_value = std::max(worst_value, std::abs(cubic.at(double(k) / 3.0) - values[k]));
        }
        const std::vector<double> splits = split_at_levels(cubic, levels);
        REQUIRE(std::is_sorted(splits.begin(), splits.end()));
        for (int sample = 0; sample < 200; ++sample) {
            const double a = (sample + 0.25) / 200.0, b = (sample + 0.75) / 200.0;
            for (const double level : levels) {
                if ((cubic.at(a) < level) == (cubic.at(b) < level)) continue;
                const auto split = std::lower_bound(splits.begin(), splits.end(), a);
                REQUIRE((split != splits.end() && *split <= b));
            }
        }
    }
    check_below("interpolation", worst_value, 1e-14);
    CHECK(split_at_levels(cubic_through({0.3, 0.3, 0.3, 0.3}), std::vector{0.3}).size() == 2);
}

TEST_CASE("random volumes agree with brute force, and with themselves cut otherwise")
{
    Scene scene = noise_scene({9, 7, 8}, 6);
    scene.points = {{0.0, {1, 0, 0}, 0.0}, {0.4, {0, 1, 0}, 0.6}, {1.0, {0, 0, 1}, 0.05}};
    scene.spacing = {1.0, 1.5, 0.8};
    check_below("continuous function", worst_against_brute_force(scene, 3, 500000, 7), 1e-9);
    check_below("continuous function, in parts", worst_against_parts(scene, 20, 97, 7), 1e-12);
    // A sum of samples cannot place a step better than to a sample.
    scene.points = busy_points();
    check_below("function with a step", worst_against_brute_force(scene, 3, 500000, 8), 1e-5);
    check_below("function with a step, in parts", worst_against_parts(scene, 20, 97, 8), 1e-12);
}

TEST_CASE("a spike of 1/256 is not missed")
{
    Scene scene = noise_scene({9, 9, 9}, 9);
    const double half_width = 0.5 / 256.0;
    scene.points = {{0.0, ORANGE, 0.0},
                    {0.5 - half_width, ORANGE, 0.0},
                    {0.5, {0, 1, 1}, 0.99},
                    {0.5 + half_width, ORANGE, 0.0},
                    {1.0, ORANGE, 0.0}};
    check_below("spike", worst_against_brute_force(scene, 3, 2000000, 10), 1e-6);
    check_below("spike, in parts", worst_against_parts(scene, 20, 97, 10), 1e-12);
}

TEST_CASE("a mask overrides the density, and a hidden group is empty")
{
    Scene scene = noise_scene({8, 8, 8}, 11);
    scene.points = {{0.0, {1, 0, 0}, 0.0}, {1.0, {0, 0, 1}, 0.4}};
    std::mt19937 random(12);
    for (size_t i = 0; i < scene.density.size(); ++i) scene.labels.push_back(uint8_t(random() % 4));
    scene.groups[1] = {.color = {0.2, 0.9, 0.1}, .opacity = 0.3};
    scene.groups[2] = {.color = {0.9, 0.9, 0.1}, .opacity = 0.02};
    scene.groups[3] = {.color = {1.0, 1.0, 1.0}, .opacity = 1.0, .visible = false};
    check_below("mask", worst_against_brute_force(scene, 3, 500000, 13), 1e-4);

    // One painted voxel in an empty volume, and the same made opaque.
    std::fill(scene.labels.begin(), scene.labels.end(), uint8_t(0));
    scene.labels[size_t(3 + 8 * (4 + 8 * 5))] = 1;
    scene.points.clear();
    const glm::dvec4 expected(0.3 * scene.groups[1].color, 0.3);
    check_below("voxel", largest_difference(integrate_exact(scene, along_x(4.9, 5.2)), expected), 1e-14);
    CHECK(integrate_exact(scene, along_x(5.01, 5.2)) == glm::dvec4(0.0));
    scene.groups[1].opacity = 1.0;
    CHECK(integrate_exact(scene, along_x(4.9, 5.2)) == glm::dvec4(scene.groups[1].color, 1.0));
    scene.groups[1].visible = false;
    CHECK(integrate_exact(scene, along_x(4.9, 5.2)) == glm::dvec4(0.0));
}

TEST_CASE("shading of a plane follows the equations")
{
    // Gradient (0.02, 0, 0.01) per voxel; spacing 1, 1, 2 makes it (0.02, 0, 0.005) per reference voxel.
    Scene scene = scene_of({12, 12, 12}, [](glm::dvec3 p) { return 0.1 + 0.02 * p.x + 0.01 * p.z; });
    scene.points = {{0.0, ORANGE, 0.1}, {1.0, ORANGE, 0.1}};
    scene.spacing = {1.0, 1.0, 2.0};
    scene.cut_min = glm::dvec3(2.0);
    scene.cut_max = glm::dvec3(10.0);
    scene.shading = Shading{
        .ambient = 0.2, .diffuse = 0.5, .specular = 0.3, .shininess = 7.0, .fade = 0.03, .to_light = {-3.0, 1.0, 0.0}};
    const double slope2 = 0.02 * 0.02 + 0.005 * 0.005, slope = std::sqrt(slope2);
    const double w = slope2 / (slope2 + 0.0009);
    const glm::dvec3 normal = glm::dvec3(-0.02, 0.0, -0.005) / slope;
    const glm::dvec3 to_light = glm::dvec3(-3.0, 1.0, 0.0) / std::sqrt(10.0), to_eye(-1.0, 0.0, 0.0);
    const double facing = normal.x * to_light.x;
    const double glint = 0.3 * std::pow(glm::dot(normal, glm::normalize(to_light + to_eye)), 7.0);
    const double opacity = opacity_of(8.0 * extinction(0.1));
    const auto check_color = [&](const char* what, const glm::dvec3& color) {
        const glm::dvec4 light = integrate_exact(scene, along_x(6.0, 6.0));
        check_below(what, largest_difference(light, glm::dvec4(color * opacity, opacity)), 1e-13);
    };
    check_color("lit", ORANGE * (0.2 + 0.5 * (1.0 - w + w * facing)) + w * glint);
    scene.shading->to_light = {3.0, -1.0, 0.0};
    check_color("dark side", ORANGE * (0.2 + 0.5 * (1.0 - w)));
    scene.shading->to_light = {-3.0, 1.0, 0.0};
    scene.shading->fade = 0.0;
    check_color("every slope a surface", ORANGE * (0.2 + 0.5 * facing) + glint);
    scene.shading->ambient = 9.0;
    check_color("clamped once", glm::dvec3(1.0));
}

TEST_CASE("a flat region shows ambient and diffuse light in full")
{
    Scene scene = constant_scene({8, 8, 8}, 0.2);
    const double opacity = opacity_of(8.0 * extinction(0.2));
    for (const double fade : {0.0, 0.03}) {
        scene.shading = Shading{.ambient = 0.3, .diffuse = 0.45, .specular = 1.0, .fade = fade};
        const glm::dvec4 light = integrate_exact(scene, along_x(4.0, 4.0));
        check_below("flat", largest_difference(light, glm::dvec4(0.75 * ORANGE * opacity, opacity)), 1e-14);
    }
    // A light exactly behind the surface leaves no half vector; nothing may become NaN.
    Scene ramp = scene_of({8, 8, 8}, [](glm::dvec3 p) { return p.x / 8.0; });
    ramp.points = scene.points;
    ramp.shading = Shading{.to_light = {1.0, 0.0, 0.0}};
    CHECK(std::isfinite(integrate_exact(ramp, along_x(4.0, 4.0)).r));
}

TEST_CASE("shaded random volumes agree with brute force, and with themselves cut otherwise")
{
    Scene scene = noise_scene({6, 6, 6}, 14);
    scene.points = {{0.0, {0.9, 0.2, 0.1}, 0.05}, {0.5, {0, 1, 0}, 0.3}, {1.0, {0.1, 0.1, 0.8}, 0.1}};
    scene.spacing = {1.0, 1.0, 1.4};
    scene.shading = Shading{.specular = 0.0, .fade = 0.05, .to_light = {0.3, -0.5, 0.8}};
    check_below("diffuse", worst_against_brute_force(scene, 2, 200000, 15), 1e-9);
    // The highlight jumps where the surface turns from the light, and clamping makes kinks: hard on sums of samples.
    scene.shading->specular = 0.8;
    scene.shading->shininess = 20.0;
    check_below("highlight", worst_against_brute_force(scene, 2, 200000, 15), 2e-6);
    for (const double ambient : {0.3, 0.9}) {
        scene.shading->ambient = ambient;
        check_below("highlight, in parts", worst_against_parts(scene, 30, 97, 15), 1e-11);
    }
}

TEST_CASE("halving the tolerance changes nothing")
{
    Scene scene = noise_scene({9, 9, 9}, 16);
    scene.points = busy_points();
    std::mt19937 random(17);
    for (const bool shade : {false, true}) {
        if (shade) scene.shading = Shading{};
        double worst = 0.0;
        for (int i = 0; i < 30; ++i) {
            const Ray ray = random_ray(scene, random);
            const glm::dvec4 finer = integrate_exact(scene, ray, {.tolerance = 0.5 * ExactOptions{}.tolerance});
            worst = std::max(worst, largest_difference(integrate_exact(scene, ray), finer));
        }
        check_below(shade ? "shaded" : "unshaded", worst, shade ? 1e-10 : 1e-12);
    }
}

TEST_CASE("the discrete model places, weighs and stops its samples as documented")
{
    Scene scene = scene_of({4, 1, 1}, [](glm::dvec3 p) { return p.x / 4.0; });
    scene.points = {{0.0, ORANGE, 0.0}, {1.0, ORANGE, 0.8}};
    scene.cut_max.x = 3.5;
    // Steps of 1.5 over 3.5 voxels from x = 0: [0, 1.5], [1.5, 3], rest [3, 3.5]. Density is x/4, clamped below 0.5.
    const auto composed = [&](double x0, double x1, double x2) {
        const auto part = [](double x, double length) { return std::pow(1.0 - 0.2 * std::max(x, 0.5), length); };
        return 1.0 - part(x0, 1.5) * part(x1, 1.5) * part(x2, 0.5);
    };
    const Ray ray = along_x(0.5, 0.5);
    const double middle = integrate_discrete(scene, ray, {.step = 1.5}).a;
    check_below("middle", std::abs(middle - composed(0.75, 2.25, 3.25)), 1e-15);
    const double front = integrate_discrete(scene, ray, {.step = 1.5, .sample_at = 0.0}).a;
    check_below("front", std::abs(front - composed(0.0, 1.5, 3.0)), 1e-15);
    const double first = 1.0 - std::pow(1.0 - 0.15, 1.5), second = 1.0 - std::pow(1.0 - 0.45, 1.5);
    const glm::dvec4 two = integrate_discrete(scene, ray, {.step = 1.5, .stop_opacity = 0.5});
    const double opacity = first + (1.0 - first) * second;
    check_below("stopped", largest_difference(two, glm::dvec4(ORANGE * opacity, opacity)), 1e-15);
}

TEST_CASE("the discrete model converges to the exact one with second order at midpoints, first at front ends")
{
    const auto wave = [](glm::dvec3 p) { return std::sin(0.5 * p.x) * std::cos(0.4 * p.y) * std::sin(0.3 * p.z); };
    Scene scene = scene_of({12, 12, 12}, [&](glm::dvec3 p) { return 0.5 + 0.4 * wave(p); });
    scene.points = {{0.0, {1, 0, 0}, 0.0}, {1.0, {0, 0, 1}, 0.4}};
    std::mt19937 random(18);
    std::vector<Ray> rays;
    for (int i = 0; i < 60; ++i) rays.push_back(random_ray(scene, random));
    const std::vector<glm::dvec4> exact = render(scene, rays, ExactOptions{});
    for (const auto& [sample_at, least_order, most_order] : {std::tuple(0.5, 1.8, 2.5), {0.0, 0.8, 1.2}}) {
        const auto error = [&](double step) {
            const DiscreteOptions options{.step = step, .sample_at = sample_at};
            const std::vector<glm::dvec4> stepped = render(scene, rays, options);
            double sum = 0.0;
            for (size_t i = 0; i < rays.size(); ++i) sum += std::pow(largest_difference(stepped[i], exact[i]), 2.0);
            return std::sqrt(sum / double(rays.size()));
        };
        const double order = std::log2(error(0.5) / error(0.5 / 32.0)) / 5.0;
        INFO("order ", order);
        CHECK(order >= least_order);
        CHECK(order <= most_order);
    }
}

TEST_CASE("a transfer table converges to the function it samples")
{
    Scene scene = noise_scene({8, 8, 8}, 19);
    scene.points = {{0.2, {1, 0, 0}, 0.0}, {0.8, {0, 0, 1}, 0.9}};
    std::mt19937 random(20);
    const Ray ray = random_ray(scene, random);
    const auto error = [&](uint32_t entries) {
        return largest_difference(integrate_discrete(scene, ray, {.step = 0.4, .table_entries = entries}),
                                  integrate_discrete(scene, ray, {.step = 0.4}));
    };
    CHECK(error(2) > 1e-3);
    check_below("65536 entries", error(65536), 1e-9);
    const double order = std::log2(error(33) / error(1025)) / 5.0;
    INFO("order ", order);
    CHECK(order > 1.8);
    scene.points = {{0.0, ORANGE, 0.3}, {1.0, ORANGE, 0.3}};
    check_below("constant", error(2), 1e-14);
}

TEST_CASE("differences over one voxel see the Marschner-Lobb signal as well as is known")
{
    // Known for 64^3 samples of [-1, 1]^3: trilinear values 1.6e-2 rms, normals 9.3 degrees rms.
    const int n = 64;
    const double pi = std::numbers::pi;
    const auto to_signal = [&](glm::dvec3 voxel) { return (voxel - 0.5) * (2.0 / (n - 1)) - 1.0; };
    const auto ripple = [&](double r) { return std::cos(12.0 * pi * std::cos(0.5 * pi * r)); };
    const auto value = [&](glm::dvec3 p) {
        return (1.0 - std::sin(0.5 * pi * p.z) + 0.25 * (1.0 + ripple(std::hypot(p.x, p.y)))) / 2.5;
    };
    const Scene scene = scene_of(glm::ivec3(n), [&](glm::dvec3 voxel) { return value(to_signal(voxel)); });
    std::mt19937 random(21);
    std::uniform_real_distribution<double> uniform(3.0, n - 3.0);
    double value_error = 0.0, angle_error = 0.0;
    const int samples = 20000;
    for (int i = 0; i < samples; ++i) {
        const glm::dvec3 voxel(uniform(random), uniform(random), uniform(random)), p = to_signal(voxel);
        const double r = std::hypot(p.x, p.y);
        const double phase = 12.0 * pi * std::cos(0.5 * pi * r);
        const double slope = 0.25 * std::sin(phase) * 6.0 * pi * pi * std::sin(0.5 * pi * r);
        const glm::dvec3 gradient(slope * p.x / r, slope * p.y / r, -0.5 * pi * std::cos(0.5 * pi * p.z));
        const glm::dvec3 difference = difference_at(scene, voxel);
        const double sine = glm::length(glm::cross(gradient, difference));
        const double angle = std::atan2(sine, glm::dot(gradient, difference));
        value_error += std::pow(density_at(scene, voxel) - value(p), 2.0) / samples;
        angle_error += std::pow(angle * 180.0 / pi, 2.0) / samples;
    }
    INFO("rms value ", std::sqrt(value_error), ", degrees ", std::sqrt(angle_error));
    CHECK(std::sqrt(value_error) == doctest::Approx(1.6e-2).epsilon(0.05));
    CHECK(std::sqrt(angle_error) == doctest::Approx(9.3).epsilon(0.05));
}

TEST_CASE("an image is the same on any number of threads")
{
    Scene scene = noise_scene({8, 8, 8}, 22);
    scene.points = busy_points();
    std::mt19937 random(23);
    std::vector<Ray> rays;
    for (int i = 0; i < 40; ++i) rays.push_back(random_ray(scene, random));
    const std::vector<glm::dvec4> one = render(scene, rays, ExactOptions{}, 1);
    CHECK(render(scene, rays, ExactOptions{}, 3) == one);
    for (size_t i = 0; i < rays.size(); ++i) CHECK(integrate_exact(scene, rays[i]) == one[i]);
    scene.density.pop_back();
    CHECK_THROWS_AS(render(scene, rays, ExactOptions{}), std::invalid_argument);
}
