#include "engine/movie/camera_path.h"

#include <cmath>

#include <doctest/doctest.h>

#include "engine/look/camera_motion.h"

using namespace shvr;

namespace {

VolumeInfo volume_of(const glm::i64vec3& size)
{
    VolumeInfo volume;
    volume.size = size;
    volume.spacing = glm::dvec3(1.0);
    return volume;
}

const VolumeInfo VOLUME = volume_of({20, 30, 40});

Camera from_side(const std::string& side)
{
    return camera_looking(side, VOLUME);
}

glm::dvec3 backward(const Camera& camera)
{
    return -axes_of(camera).forward;
}

bool is_near(const glm::dvec3& a, const glm::dvec3& b)
{
    return glm::distance(a, b) < 1e-9;
}

}  // namespace

TEST_CASE("a movie eases: it begins and ends without speed, and half of the way lies behind it half-way")
{
    CHECK(eased(0.0) == 0.0);
    CHECK(eased(0.5) == 0.5);
    CHECK(eased(1.0) == 1.0);
    CHECK(eased(1e-4) < 1e-7);
    CHECK(1.0 - eased(1.0 - 1e-4) < 1e-7);
}

TEST_CASE("the ends of a camera's way are exactly its two views")
{
    const Camera from = from_side("front"), to = from_side("top");
    CHECK(camera_between(from, to, 0.0, VOLUME) == from);
    CHECK(camera_between(from, to, 1.0, VOLUME) == to);
    CHECK(camera_between(from, from, 0.3, VOLUME) == from);
}

TEST_CASE("a camera turns the shortest way, at its distance from the target")
{
    const Camera from = from_side("front"), to = from_side("right");
    const Camera middle = camera_between(from, to, 0.5, VOLUME);
    CHECK(is_near(backward(middle), glm::normalize(glm::dvec3(1, -1, 0))));
    CHECK(is_near(axes_of(middle).up, {0, 0, 1}));
    CHECK(glm::distance(middle.eye, middle.target) == doctest::Approx(glm::distance(from.eye, from.target)));
    const Camera third = camera_between(from, to, 1.0 / 3.0, VOLUME);
    CHECK(glm::dot(backward(third), backward(from)) == doctest::Approx(std::cos(radians(30.0))));
}

TEST_CASE("a half turn moves the eye to its right, in each direction")
{
    CHECK(is_near(backward(camera_between(from_side("front"), from_side("back"), 0.5, VOLUME)), {1, 0, 0}));
    CHECK(is_near(backward(camera_between(from_side("back"), from_side("front"), 0.5, VOLUME)), {-1, 0, 0}));
    // Upside down: the axis is horizontal in the picture, and the eye moves up.
    Camera below = from_side("back");
    below.up = {0, 0, -1};
    CHECK(is_near(backward(camera_between(from_side("front"), below, 0.5, VOLUME)), {0, 0, 1}));
}

TEST_CASE("targets move straight; distances and heights change by equal factors; angles and planes linearly")
{
    Camera from = from_side("front"), to = from;
    from.eye = {0, -8, 0}, from.target = {0, 0, 0}, from.height = 8.0, from.near_distance = 1.0;
    to.eye = {4, -2, 0}, to.target = {4, 0, 0}, to.height = 2.0, to.near_distance = 2.0;
    from.fov_y_degrees = 20.0, to.fov_y_degrees = 40.0;
    from.shift_right = -0.5;
    const Camera middle = camera_between(from, to, 0.5, VOLUME);
    CHECK(is_near(middle.target, {2, 0, 0}));
    CHECK(is_near(middle.eye, {2, -4, 0}));
    CHECK(middle.height == doctest::Approx(4.0));
    CHECK(middle.near_distance == doctest::Approx(1.5));
    CHECK(middle.fov_y_degrees == doctest::Approx(30.0));
    CHECK(middle.shift_right == doctest::Approx(-0.25));
    CHECK(middle.far_distance == 0.0);
}

TEST_CASE("a far clip plane comes from behind the whole volume")
{
    Camera from = from_side("front"), to = from;
    to.far_distance = glm::distance(to.eye, to.target);
    const Camera first = camera_between(from, to, 1e-6, VOLUME);
    const double radius = 0.5 * glm::length(glm::dvec3(VOLUME.size));
    CHECK(first.far_distance == doctest::Approx(to.far_distance + radius));
    CHECK(camera_between(from, to, 0.5, VOLUME).far_distance == doctest::Approx(to.far_distance + 0.5 * radius));
}

TEST_CASE("a turntable turns about the axis of the volume that points upwards, also for a tilted view")
{
    CHECK(turntable_axis(from_side("front")) == glm::dvec3(0, 0, 1));
    CHECK(turntable_axis(from_side("top")) == glm::dvec3(0, 1, 0));
    const Camera tilted = camera_of(SideView{.side = "left", .tilt_degrees = 30.0}, VOLUME);
    CHECK(turntable_axis(tilted) == glm::dvec3(0, 0, 1));
    const Camera halfway = camera_of(SideView{.side = "front", .tilt_degrees = 45.0}, VOLUME);
    CHECK(turntable_axis(halfway) == glm::dvec3(0, 0, 1));
    Camera upside_down = from_side("front");
    upside_down.up = {0, 0, -1};
    CHECK(turntable_axis(upside_down) == glm::dvec3(0, 0, -1));
}

TEST_CASE("a turned camera keeps its height and its target, and its eye moves to the right")
{
    const Camera tilted = camera_of(SideView{.side = "front", .tilt_degrees = 30.0}, VOLUME);
    const Camera quarter = turned(tilted, {0, 0, 1}, 90.0);
    CHECK(quarter.target == tilted.target);
    CHECK(quarter.eye.z == doctest::Approx(tilted.eye.z));
    const Camera right = camera_of(SideView{.side = "right", .tilt_degrees = 30.0}, VOLUME);
    CHECK(is_near(quarter.eye, right.eye));
    CHECK(is_near(axes_of(quarter).up, axes_of(right).up));
    CHECK(turned(tilted, {0, 0, 1}, 0.0) == tilted);
}
