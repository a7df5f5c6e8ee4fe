#include "engine/look/camera_motion.h"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

constexpr glm::uvec2 PIXELS(640, 480);

double uniform(std::mt19937& random, double low, double high)
{
    return low + (high - low) * double(random()) / 4294967296.0;
}

glm::dvec3 point(std::mt19937& random, double size)
{
    const double x = uniform(random, -size, size), y = uniform(random, -size, size);
    return {x, y, uniform(random, -size, size)};
}

Camera random_camera(std::mt19937& random)
{
    Camera camera;
    camera.projection = random() % 2 == 0 ? Camera::Projection::perspective : Camera::Projection::orthographic;
    camera.eye = point(random, 100.0);
    camera.target = camera.eye + glm::dvec3(3, 4, 12) + point(random, 2.0);
    camera.up = {0.1, 1.0, 0.2};
    camera.fov_y_degrees = uniform(random, 10.0, 90.0);
    camera.height = uniform(random, 1.0, 50.0);
    return camera;
}

bool is_near(const glm::dvec3& a, const glm::dvec3& b)
{
    return glm::distance(a, b) < 1e-9 * (1.0 + glm::length(a));
}

}  // namespace

TEST_CASE("a camera for another spacing sees the same voxels in the middle, and cuts them at the same depth")
{
    Camera camera{.eye = {40, -60, 25}, .target = {10, 12, 14}, .up = {0, 0, 1}, .near_distance = 30.0};
    for (const Camera::Projection projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        camera.projection = projection;
        camera.height = 50.0;
        for (const glm::dvec3& ratio : {glm::dvec3(0.25), glm::dvec3(0.5, 0.5, 2.0), glm::dvec3(3.0, 1.0, 0.2)}) {
            const Camera other = respaced(camera, ratio);
            const CameraAxes before = axes_of(camera), after = axes_of(other);
            const glm::dvec3 cut = camera.eye + camera.near_distance * before.forward;
            CHECK(glm::dot(cut * ratio - other.eye, after.forward) == doctest::Approx(other.near_distance));
            CHECK(glm::distance(project(other, {80, 60}, camera.target * ratio)->pixel, glm::dvec2(40, 30)) < 1e-9);
            if (ratio.x != ratio.y || ratio.y != ratio.z) continue;
            const glm::dvec3 beside = camera.target + 5.0 * before.right + 3.0 * before.up;
            const glm::dvec2 seen = project(camera, {80, 60}, beside)->pixel;
            CHECK(glm::distance(project(other, {80, 60}, beside * ratio)->pixel, seen) < 1e-9);
        }
    }
}

TEST_CASE("a point goes to a pixel and back")
{
    std::mt19937 random(91);  // seed 91
    for (int trial = 0; trial < 200; ++trial) {
        const Camera camera = random_camera(random);
        const glm::dvec2 pixel(uniform(random, 0, 640), uniform(random, 0, 480));
        const double depth = uniform(random, 0.5, 40.0);
        const glm::dvec3 there = unproject(camera, PIXELS, pixel, depth);
        const std::optional<Projected> seen = project(camera, PIXELS, there);
        REQUIRE(seen);
        CHECK(glm::distance(seen->pixel, pixel) < 1e-6);
        CHECK(seen->depth == doctest::Approx(depth));
    }
}

TEST_CASE("what a ray passes through is seen at the ray's pixel")
{
    std::mt19937 random(92);  // seed 92
    const VolumeInfo volume{.name = "", .format = "", .size = {64, 64, 64}, .spacing = {1.0, 0.5, 2.0}};
    for (int trial = 0; trial < 200; ++trial) {
        Camera camera = camera_looking("front", volume);
        camera = orbited(camera, camera.target, uniform(random, -180, 180), uniform(random, -80, 80));
        const RayPlanes planes = ray_planes(camera, PIXELS, volume);
        const glm::dvec2 pixel(double(random() % 640) + 0.5, double(random() % 480) + 0.5);
        const glm::dvec3 near = planes.near_corner + pixel.x * planes.near_dx + pixel.y * planes.near_dy;
        const glm::dvec3 far = planes.far_corner + pixel.x * planes.far_dx + pixel.y * planes.far_dy;
        const double share = uniform(random, 0.0, 1.0);
        const auto seen = project(camera, PIXELS, (near + share * (far - near)) * volume.spacing);
        REQUIRE(seen);
        CHECK(glm::distance(seen->pixel, pixel) < 1e-6);
    }
}

TEST_CASE("turning keeps the distance to the pivot, and turning back leads back")
{
    std::mt19937 random(93);  // seed 93
    for (int trial = 0; trial < 100; ++trial) {
        const Camera camera = random_camera(random);
        const glm::dvec3 pivot = point(random, 50.0);
        const Camera turned = orbited(camera, pivot, 37.0, 0.0);
        CHECK(glm::distance(turned.eye, pivot) == doctest::Approx(glm::distance(camera.eye, pivot)));
        CHECK(glm::distance(turned.eye, turned.target) == doctest::Approx(glm::distance(camera.eye, camera.target)));
        const Camera back = orbited(turned, pivot, -37.0, 0.0);
        CHECK(is_near(back.eye, camera.eye));
        CHECK(is_near(back.target, camera.target));
        CHECK(axes_of(rolled(rolled(camera, 50.0), -50.0)).up.x == doctest::Approx(axes_of(camera).up.x));
    }
}

TEST_CASE("turning right moves the eye to the viewer's right, turning up raises it")
{
    Camera camera;
    camera.eye = {0, 0, 10};
    camera.up = {0, 1, 0};
    CHECK(orbited(camera, glm::dvec3(0.0), 10.0, 0.0).eye.x > 1.0);
    CHECK(orbited(camera, glm::dvec3(0.0), 0.0, 10.0).eye.y > 1.0);
    CHECK(is_near(moved(camera, {1, 2, 3}).eye, {1, 2, 7}));
    // After rolling clockwise for the viewer, the old up leans to the right: the camera's own up leans to the left.
    CHECK(axes_of(rolled(camera, 10.0)).up.x < -0.1);
}

TEST_CASE("zooming keeps what is under the mouse where it is")
{
    std::mt19937 random(94);  // seed 94
    for (int trial = 0; trial < 100; ++trial) {
        const Camera camera = random_camera(random);
        const glm::dvec2 pixel(uniform(random, 0, 640), uniform(random, 0, 480));
        const double depth = glm::distance(camera.eye, camera.target);
        const glm::dvec3 under = unproject(camera, PIXELS, pixel, depth);
        const Camera closer = zoomed(camera, PIXELS, pixel, 1.7);
        const auto seen = project(closer, PIXELS, under);
        REQUIRE(seen);
        CHECK(glm::distance(seen->pixel, pixel) < 1e-6);
        CHECK(pixel_size(closer, PIXELS, glm::distance(closer.eye, closer.target)) ==
              doctest::Approx(pixel_size(camera, PIXELS, depth) / 1.7));
    }
}

TEST_CASE("the pixels of a ball or a box are all that may show it")
{
    std::mt19937 random(95);  // seed 95
    for (int trial = 0; trial < 200; ++trial) {
        const Camera camera = random_camera(random);
        const double depth = uniform(random, 5.0, 30.0), radius = uniform(random, 0.1, 2.0);
        const glm::dvec3 center = unproject(camera, PIXELS, {uniform(random, 0, 640), uniform(random, 0, 480)}, depth);
        const PixelBox ball = pixels_of_ball(camera, PIXELS, center, radius);
        const PixelBox box = pixels_of_box(camera, PIXELS, center - radius, center + radius);
        for (int i = 0; i < 50; ++i) {
            const glm::dvec3 direction = glm::normalize(point(random, 1.0) + 1e-9);
            const auto seen = project(camera, PIXELS, center + radius * direction);
            if (!seen) continue;
            const glm::dvec2 pixel = glm::floor(seen->pixel);
            if (pixel.x < 0 || pixel.y < 0 || pixel.x >= 640 || pixel.y >= 480) continue;
            for (const PixelBox& part : {ball, box}) {
                CHECK(glm::all(glm::greaterThanEqual(pixel, glm::dvec2(part.begin))));
                CHECK(glm::all(glm::lessThan(pixel, glm::dvec2(part.end))));
            }
        }
    }
    Camera camera;
    camera.eye = {0, 0, 10};
    camera.up = {0, 1, 0};
    CHECK(pixels_of_ball(camera, PIXELS, {0, 0, 10.5}, 1.0) == PixelBox{glm::uvec2(0), PIXELS});  // around the eye
    CHECK(pixels_of_ball(camera, PIXELS, {1000, 0, 0}, 1.0).empty());
}

TEST_CASE("Fitting shows all of a box, near its margin, from where one looks; planes stay where they are")
{
    std::mt19937 random(31);
    for (int i = 0; i < 200; ++i) {
        Camera camera = random_camera(random);
        camera.near_distance = 2.0;
        camera.far_distance = 30.0;
        const glm::dvec3 lower = point(random, 40.0), upper = lower + glm::abs(point(random, 40.0)) + 0.1;
        const Camera fit = fitted(camera, PIXELS, lower, upper);
        const CameraAxes before = axes_of(camera), after = axes_of(fit);
        CHECK(is_near(before.forward, after.forward));
        CHECK(is_near(before.up, after.up));
        CHECK(is_near(fit.target, 0.5 * (lower + upper)));
        glm::dvec2 most(0.0);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 at(corner & 1 ? upper.x : lower.x, corner & 2 ? upper.y : lower.y,
                                corner & 4 ? upper.z : lower.z);
            const auto seen = project(fit, PIXELS, at);
            REQUIRE(seen.has_value());
            CHECK(seen->depth > 0.0);
            most = glm::max(most, glm::abs(seen->pixel - 0.5 * glm::dvec2(PIXELS)) / (0.5 * glm::dvec2(PIXELS)));
        }
        CHECK(std::max(most.x, most.y) <= 1.0);
        CHECK(std::max(most.x, most.y) > 0.9);
        const auto plane = [&](const Camera& each, double distance) {
            return glm::dot(each.eye, before.forward) + distance;
        };
        if (fit.near_distance > 0.0) CHECK(plane(fit, fit.near_distance) == doctest::Approx(plane(camera, 2.0)));
    }
}

TEST_CASE("Looking at a point keeps direction and distance")
{
    std::mt19937 random(37);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(random);
        const glm::dvec3 target = point(random, 60.0);
        const Camera turned = looking_at(camera, target);
        CHECK(is_near(turned.target, target));
        CHECK(is_near(turned.eye - turned.target, camera.eye - camera.target));
    }
}
