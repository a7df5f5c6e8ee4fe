// Where rays begin, run and end: every pixel of pictures of noise, the roughest possible volume, against the same
// samples composited in double along rays computed in double.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Positions in float are up to 8e-6 voxel off at 100 voxels; noise changes by up to 1 per voxel, opacity by 0.3 per
/// unit.
constexpr double POSITIONS = 2e-5;
/// Lengths of up to 1000 along a ray, with spacings that differ by 20, are 3e-5 off.
constexpr double LONG_RAYS = 5e-5;
/// A ray that leaves a face at the angle phi enters 4e-6 / phi off its true position, as do all its samples: the few
/// rays that graze the face that contains the eye.
constexpr double GRAZING_RAYS = 2e-3;

Session noise_session(const glm::uvec2& pixels = {24, 24})
{
    return plain_session(busy_points(0.1), pixels);
}

double extent_of(const TestVolume& volume)
{
    return glm::length(glm::dvec3(volume.size) * volume.spacing);
}

glm::dvec3 centre_of(const TestVolume& volume)
{
    return 0.5 * glm::dvec3(volume.size) * volume.spacing;
}

/// The largest channel error of each pixel.
std::vector<double> differences(const Pixels& a, const Pixels& b)
{
    std::vector<double> differences;
    for (size_t i = 0; i < a.size(); ++i) differences.push_back(worst_difference({a[i]}, {b[i]}));
    std::ranges::sort(differences);
    return differences;
}

/// Perspective, from so far that its picture equals `camera`'s.
Camera from_afar(const Camera& camera, double distance)
{
    Camera far = camera;
    far.projection = Camera::Projection::perspective;
    far.eye = camera.target + glm::normalize(camera.eye - camera.target) * distance;
    far.fov_y_degrees = glm::degrees(2.0 * std::atan(0.5 * camera.height / distance));
    return far;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "rays run in all 26 directions of a cube")
{
    load(noise_volume({33, 33, 33}, 11));
    for (const glm::dvec3& direction : cube_directions()) {
        CAPTURE(direction.x);
        CAPTURE(direction.y);
        CAPTURE(direction.z);
        check_below("orthographic", error(noise_session(), camera_along(volume(), direction, 61.0)), POSITIONS);
        const Camera near = perspective(centre_of(volume()) - 45.0 * direction, centre_of(volume()), 50.0);
        check_below("perspective", error(noise_session(), near), POSITIONS);
    }
}

TEST_CASE_FIXTURE(OnDevice, "rays that run exactly in faces and edges of the volume and of its voxels are drawn")
{
    // An odd number of pixels, one voxel apart: rays run at x, y = 0, 1 ... 8, including the volume's faces.
    load(noise_volume({8, 8, 8}, 12));
    const Session session = noise_session({11, 11});
    for (const glm::dvec3& direction : cube_directions()) {
        if (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z) > 1.0) continue;
        CAPTURE(direction.x);
        CAPTURE(direction.y);
        CAPTURE(direction.z);
        const Camera camera = camera_along(volume(), direction, 11.0);
        check_below("faces", error(session, camera), POSITIONS);
        const Pixels pixels = pixels_of(draw(session, camera));
        for (const size_t corner : {1 + 11 * 1, 9 + 11 * 1, 1 + 11 * 9, 9 + 11 * 9}) CHECK(pixels[corner].r > 0.01);
        for (size_t i = 0; i < 11; ++i) CHECK(pixels[i] == glm::dvec4(0.0, 0.0, 0.0, 1.0));
    }
}

TEST_CASE_FIXTURE(OnDevice, "rays within an ulp of a face are drawn or not, but never half")
{
    load(constant_volume({8, 8, 8}, 30000.0));
    const Session session = plain_session(uniform_points(RED, 0.1), {1, 1});
    const double inside = RED.r * opacity_of_depth(8.0 * depth_of_opacity(0.1));
    for (const glm::dvec3& side : {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0.6, 0.8)}) {
        for (const double away : {-1e-5, -5e-7, -1e-7, 0.0, 1e-7, 5e-7, 1e-5}) {
            Camera camera = camera_along(volume(), {1, 0, 0}, 1.0);
            const glm::dvec3 offset = side * (4.0 + away);
            camera.eye += offset;
            camera.target += offset;
            const double red = pixels_of(draw(session, camera))[0].r;
            CAPTURE(away);
            check_below("off being drawn, and off not being", std::min(red, std::abs(red - inside)), 1e-5);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "components of either zero and below the normal numbers are no direction")
{
    load(noise_volume({12, 12, 12}, 13));
    const Session session = noise_session({12, 12});
    Camera camera = camera_along(volume(), {1, 0, 0}, 14.0);
    const ImageF expected = draw(session, camera);
    for (const double component : {-0.0, 5e-324, -1e-310, 1e-39, -1e-45}) {
        CAPTURE(component);
        Camera tilted = camera;
        tilted.up = {component, component, 1.0};
        // The centre is not at 0, where such numbers survive an addition: move the eye in a frame where it is.
        tilted.eye.y += component;
        check_below("differing bits", double(different_bits(draw(session, tilted), expected)), 0.0);
    }
    Camera backwards = camera_along(volume(), {-1, -0.0, 0}, 14.0);
    check_below("minus x", error(session, backwards), POSITIONS);
    // Through the corner at the origin, along its axes.
    for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0)}) {
        Camera corner = camera_along(volume(), direction, 6.0);
        corner.target = glm::dvec3(0.0);
        corner.eye = -20.0 * direction;
        check_below("corner", error(noise_session({6, 6}), corner), POSITIONS);
    }
}

TEST_CASE_FIXTURE(OnDevice, "an eye inside the volume, and at its borders, sees what lies ahead")
{
    load(noise_volume({33, 20, 40}, 14));
    const glm::dvec3 size(volume().size), centre = 0.5 * size;
    const glm::dvec3 eyes[] = {centre,
                               {0.5, 0.5, 0.5},
                               {32.0, 10.0, 20.0},
                               {0.0, 10.0, 20.0},
                               {33.0, 10.0, 20.0},
                               {16.0, 0.0, 20.0},
                               {16.0, 20.0, 20.0},
                               {0.0, 0.0, 0.0},
                               {33.0, 20.0, 40.0},
                               {16.0, 10.0, 39.99},
                               {16.0, 10.0, 40.01},
                               {-0.01, 10.0, 20.0},
                               {0.01, 19.99, 20.0}};
    for (const glm::dvec3& eye : eyes) {
        CAPTURE(eye.x);
        CAPTURE(eye.y);
        CAPTURE(eye.z);
        for (const glm::dvec3& target : {glm::dvec3(40.0, 25.0, 10.0), glm::dvec3(-5.0, -3.0, 17.0)}) {
            const Camera camera = perspective(eye, target, 100.0);
            const Pixels pixels = pixels_of(draw(noise_session(), camera));
            const Pixels truth = discrete(noise_session(), camera);
            check_below("worst", worst_difference(pixels, truth), GRAZING_RAYS);
            // Sorted: all but one in twenty pixels are within the bound of ordinary rays.
            check_below("all but a few", differences(pixels, truth)[pixels.size() * 19 / 20], POSITIONS);
        }
    }
}

// Kind (Light): an eye inside the volume
TEST_CASE_FIXTURE(OnDevice, "rays of an eye inside the volume begin at the eye")
{
    constexpr double OPACITY = 0.17;  // of a voxel's length
    load(constant_volume({16, 16, 16}, 40000.0));
    Session session = plain_session(uniform_points(WHITE, OPACITY), {1, 1});
    session.render.background = glm::dvec4(0.0);
    for (const double ahead : {1.0, 4.0}) {
        const Camera camera = perspective({16.0 - ahead, 8.0, 8.0}, {40.0, 8.0, 8.0}, 10.0);
        const double expected = 1.0 - std::pow(1.0 - OPACITY, ahead);
        check_below("opacity ahead of the eye", std::abs(pixels_of(draw(session, camera))[0].a - expected), 1e-5);
    }
}

TEST_CASE_FIXTURE(OnDevice, "distance changes the perspective and nothing else")
{
    load(noise_volume({33, 33, 33}, 15));
    const Camera camera = camera_along(volume(), {0.6, -0.5, 0.3}, 50.0);
    const Pixels flat = pixels_of(draw(noise_session(), camera));
    for (const double sizes : {1.0, 1e3, 1e4, 1e5, 1e6, 1e7}) {
        CAPTURE(sizes);
        const Camera far = from_afar(camera, sizes * extent_of(volume()));
        check_below("discrete", error(noise_session(), far), POSITIONS);
        // Rays diverge by the volume's size over the distance: 57 voxels / 1e7 sizes.
        if (sizes >= 1e7)
            check_below("orthographic", worst_difference(pixels_of(draw(noise_session(), far)), flat), 3e-5);
    }
    Camera far = camera;
    far.eye = camera.target + 1e7 * (camera.eye - camera.target);
    check_below("a far orthographic eye", worst_difference(pixels_of(draw(noise_session(), far)), flat), POSITIONS);
}

TEST_CASE_FIXTURE(OnDevice, "an eye a thousandth of the volume away from its face sees its voxels")
{
    load(noise_volume({33, 33, 33}, 16));
    for (const double sizes : {1e-3, 1e-2, 0.1}) {
        CAPTURE(sizes);
        const glm::dvec3 eye(-33.0 * sizes, 16.3, 16.9);
        check_below("close", error(noise_session(), perspective(eye, {10.0, 16.0, 17.0}, 90.0)), POSITIONS);
    }
}

TEST_CASE_FIXTURE(OnDevice, "voxels may have any proportions and any unit")
{
    const glm::dvec3 spacings[] = {{1.0, 1.0, 20.0},   {0.957, 0.957, 1.5}, {20.0, 1.0, 1.0},
                                   {3e-6, 3e-6, 5e-6}, {1e6, 2e6, 1e6},     {0.3, 0.5, 0.7}};
    for (const glm::dvec3& spacing : spacings) {
        CAPTURE(spacing.x);
        CAPTURE(spacing.z);
        TestVolume volume = noise_volume({40, 24, 12}, 17);
        volume.spacing = spacing;
        load(volume);
        const glm::dvec3 centre = centre_of(volume);
        const double extent = extent_of(volume);
        for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(-3, 1, -0.5), glm::dvec3(0, 0, -1)}) {
            check_below("orthographic", error(noise_session(), camera_along(volume, direction, extent)), LONG_RAYS);
            const glm::dvec3 eye = centre - 1.2 * extent * glm::normalize(direction);
            check_below("perspective", error(noise_session(), perspective(eye, centre, 40.0)), LONG_RAYS);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "volumes of every size are drawn to their last voxel")
{
    const glm::ivec3 sizes[] = {{1, 1, 1},    {2, 2, 2},    {1, 5, 1},    {3, 1, 2},    {31, 32, 33},
                                {33, 33, 33}, {64, 32, 32}, {65, 31, 34}, {100, 7, 65}, {4, 97, 4}};
    uint32_t seed = 18;
    for (const glm::ivec3& size : sizes) {
        CAPTURE(size.x);
        CAPTURE(size.y);
        CAPTURE(size.z);
        load(noise_volume(size, seed++));
        const double extent = extent_of(volume());
        for (const char* side : {"front", "right", "bottom"})
            check_below(side, error(noise_session(), camera_looking(side, volume().info())), POSITIONS);
        check_below("slanted", error(noise_session(), camera_along(volume(), {1, -2, 0.7}, extent)), POSITIONS);
        const Camera filling =
            perspective(centre_of(volume()) - glm::dvec3(0.8, 0.7, 0.6) * extent, centre_of(volume()), 35.0);
        check_below("perspective", error(noise_session({32, 32}), filling), POSITIONS);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a cut anywhere inside a volume begins and ends its rays")
{
    load(noise_volume({40, 35, 33}, 30));
    Session session = noise_session();
    const CutBox cuts[] = {{.lower = {3.3, 0.0, 0.0}, .upper = {35.7, 35.0, 33.0}},
                           {.lower = {0.0, 31.9, 0.0}, .upper = {40.0, 32.1, 33.0}},
                           {.lower = {10.0, 10.0, 10.0}, .upper = {11.0, 30.0, 20.0}},
                           {.lower = {32.0, 0.0, 0.0}, .upper = {40.0, 32.0, 32.0}},
                           {.lower = {-5.0, -1.0, 20.5}, .upper = {100.0, 1e6, 1e6}}};
    for (const CutBox& cut : cuts) {
        session.cut = cut;
        CAPTURE(cut.lower.x);
        for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(0.3, -1, 0.4), glm::dvec3(1, 1, 1)})
            check_below("cut", error(session, camera_along(volume(), direction, 50.0)), POSITIONS);
    }
}

TEST_CASE_FIXTURE(OnDevice, "pictures of any number of pixels are whole")
{
    load(noise_volume({20, 20, 20}, 31));
    const Camera camera = camera_along(volume(), {0.2, 1, 0.3}, 24.0);
    for (const glm::uvec2& pixels : {glm::uvec2(1, 1), glm::uvec2(1, 9), glm::uvec2(17, 3), glm::uvec2(131, 5),
                                     glm::uvec2(5, 131), glm::uvec2(257, 130)}) {
        CAPTURE(pixels.x);
        CAPTURE(pixels.y);
        check_below("pixels", error(noise_session(pixels), camera), POSITIONS);
    }
}
