// The emission-absorption integral on the device against closed forms, against the same samples composited in double
// ("discrete": only rounding differs) and against the integral without a step size ("exact": only the method differs).

#include <cmath>
#include <numeric>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Compositing in float, a few hundred samples.
constexpr double ROUNDING = 2e-6;
/// Closed forms whose materials change only at borders of steps, where samples in the middle are exact.
constexpr double CLOSED_FORM = 1e-5;
/// Sums of 1e5 samples as A += (1 - A) a: measured 5.6e-6 in float.
constexpr double MANY_SAMPLES = 1e-5;
/// Sliding a cut along an exponential.
constexpr double SLIDING = 2e-5;

constexpr double DEPTHS[] = {0.01, 1.0, 5.0};

Pixels filled(size_t pixels, const glm::dvec3& light, double opacity)
{
    return Pixels(pixels, glm::dvec4(light, opacity));
}

/// The colour of a homogeneous layer over opaque black.
Pixels slab(const Session& session, const glm::dvec3& color, double depth)
{
    return filled(size_t(session.render.size.x) * session.render.size.y, color * opacity_of_depth(depth), 1.0);
}

/// Opacity alone: white light over a transparent background.
Session opacity_session(double opacity, const glm::uvec2& pixels = {4, 4})
{
    Session session = plain_session(uniform_points(WHITE, opacity), pixels);
    session.render.background = glm::dvec4(0.0);
    return session;
}

/// Slope of the least-squares line through the logarithms.
double observed_order(const std::vector<double>& steps, const std::vector<double>& errors)
{
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    const auto n = double(steps.size());
    for (size_t i = 0; i < steps.size(); ++i) {
        const double a = std::log(steps[i]), b = std::log(errors[i]);
        x += a, y += b, xx += a * a, xy += a * b;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "a homogeneous slab absorbs 1 - exp(-depth), whatever the step")
{
    load(constant_volume({10, 8, 8}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 6.0);
    for (const double depth : DEPTHS) {
        Session session = plain_session(uniform_points(RED, opacity_of_depth(depth / 10.0)));
        for (const double step : {4.0, 3.3, 2.0, 1.0, 0.5, 0.25, 0.125}) {
            CAPTURE(depth);
            CAPTURE(step);
            session.render.step_voxels = step;
            const Pixels pixels = pixels_of(draw(session, camera));
            check_below("closed form", worst_difference(pixels, slab(session, RED, depth)), CLOSED_FORM);
            check_below("discrete", worst_difference(pixels, discrete(session, camera)), ROUNDING);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "a linear ramp of opacity has its closed depth")
{
    // Opacity runs from 0 at x = 0.5 to `top` at x = 10.5: the depth is ((1 - top) ln(1 - top) + top) / slope.
    load(volume_of({11, 4, 4}, [](const glm::dvec3& p) { return (p.x - 0.5) * 6553.0; }));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    for (const double top : {0.01, 0.5, 0.99}) {
        CAPTURE(top);
        Session session = plain_session({{0.0, RED, 0.0}, {65530.0, RED, top}}, {4, 4});
        session.cut = {.lower = {0.5, 0.0, 0.0}, .upper = {10.5, 4.0, 4.0}};
        session.render.step_voxels = 0.0625;
        const double depth = ((1.0 - top) * std::log1p(-top) + top) * 10.0 / top;
        const Pixels pixels = pixels_of(draw(session, camera));
        check_below("closed form", worst_difference(pixels, slab(session, RED, depth)), CLOSED_FORM);
        check_below("discrete", worst_difference(pixels, discrete(session, camera)), ROUNDING);
    }
}

TEST_CASE_FIXTURE(OnDevice, "two materials composite front over back")
{
    // The density passes 30000 at x = 5, where the material changes; steps of 0.5 have a border at 5.
    load(volume_of({10, 4, 4}, [](const glm::dvec3& p) { return p.x < 5.0 ? 20000.0 : 40000.0; }));
    const double front = 0.7, back = 1.3;
    const double a = opacity_of_depth(front / 5.0), b = opacity_of_depth(back / 5.0);
    const std::vector<ControlPoint> points = {
        {10000.0, WHITE, a}, {30000.0, WHITE, a}, {30000.0, glm::dvec3(0.25), b}, {50000.0, glm::dvec3(0.25), b}};
    Session session = plain_session(points, {4, 4});
    session.render.background = glm::dvec4(0.0);
    for (const double sign : {1.0, -1.0}) {
        const Pixels pixels = pixels_of(draw(session, camera_along(volume(), {sign, 0, 0}, 3.0)));
        const double light = sign > 0.0 ? opacity_of_depth(front) + std::exp(-front) * 0.25 * opacity_of_depth(back)
                                        : 0.25 * opacity_of_depth(back) + std::exp(-back) * opacity_of_depth(front);
        const Pixels expected = filled(16, glm::dvec3(light), opacity_of_depth(front + back));
        check_below("closed form", worst_difference(pixels, expected), CLOSED_FORM);
    }
}

TEST_CASE_FIXTURE(OnDevice, "tens of thousands of samples on a ray add up")
{
    load(constant_volume({32, 8, 8}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 6.0);
    const double samples = 1e5;
    for (const double depth : DEPTHS) {
        CAPTURE(depth);
        Session session = plain_session(uniform_points(RED, opacity_of_depth(depth / 32.0)), {2, 2});
        session.render.step_voxels = 32.0 / samples;
        const Pixels pixels = pixels_of(draw(session, camera));
        check_below("closed form", worst_difference(pixels, slab(session, RED, depth)), MANY_SAMPLES);
    }
}

TEST_CASE_FIXTURE(OnDevice, "n steps of 1/n compose to the opacity of one step")
{
    load(constant_volume({9, 4, 4}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    for (const double opacity : {0.01, 0.5, 0.99}) {
        for (const int n : {1, 4, 16, 256, 4096, 16384}) {
            CAPTURE(opacity);
            CAPTURE(n);
            Session session = opacity_session(opacity, {2, 2});
            session.cut = {.lower = {4.0, 0.0, 0.0}, .upper = {5.0, 4.0, 4.0}};
            session.render.step_voxels = 1.0 / n;
            const Pixels pixels = pixels_of(draw(session, camera));
            check_below("composed", worst_difference(pixels, filled(4, glm::dvec3(opacity), opacity)), 1e-6);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "the last step of a ray is as long as what is left of it")
{
    load(constant_volume({10, 4, 4}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    // Longer than the step, equal, shorter, and far shorter; opacities on both sides of the series' limit.
    for (const double opacity : {0.001, 0.1, 0.15, 0.9, 1.0}) {
        for (const double length : {7.0, 1.3, 1.0, 0.7, 0.05, 1e-3}) {
            CAPTURE(opacity);
            CAPTURE(length);
            Session session = opacity_session(opacity);
            session.cut = {.lower = {2.0, 0.0, 0.0}, .upper = {2.0 + length, 4.0, 4.0}};
            session.render.step_voxels = 1.0;
            const double composed = opacity == 1.0 ? 1.0 : opacity_of_depth(length * depth_of_opacity(opacity));
            const Pixels pixels = pixels_of(draw(session, camera));
            check_below("rest", worst_difference(pixels, filled(16, glm::dvec3(composed), composed)), ROUNDING);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "a cut that slides through a slab follows the exponential without a stair")
{
    load(constant_volume({16, 4, 4}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    Session session = opacity_session(0.2, {2, 2});
    for (const bool from_behind : {false, true}) {
        double before = 0.0;
        for (int i = 0; i <= 128; ++i) {
            CAPTURE(i);
            const double length = 3.0 + i / 64.0;
            session.cut.lower.x = from_behind ? 2.0 : 12.0 - length;
            session.cut.upper.x = from_behind ? 2.0 + length : 12.0;
            const Pixels pixels = pixels_of(draw(session, camera));
            const double opacity = opacity_of_depth(length * depth_of_opacity(0.2));
            check_below("exponential", worst_difference(pixels, filled(4, glm::dvec3(opacity), opacity)), SLIDING);
            CHECK(pixels[0].a > before);
            before = pixels[0].a;
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "what opacity 0 covers changes no bit of the background")
{
    load(noise_volume({20, 17, 33}, 1));
    const Camera camera = camera_looking("front", volume().info());
    for (const double alpha : {1.0, 0.5, 0.0}) {
        for (const bool skipping : {true, false}) {
            Session session = plain_session(uniform_points(RED, 0.0), {32, 32});
            session.light.shaded = true;
            session.render.skip_empty_space = skipping;
            session.render.background = {0.1, 1.0 / 3.0, 0.7, alpha};
            const ImageF image = draw(session, camera);
            ImageF expected = image;
            const glm::vec4 background(session.render.background);
            for (size_t i = 0; i < expected.rgba.size(); ++i)
                expected.rgba[i] = i % 4 == 3 ? background.a : background.a * background[int(i % 4)];
            check_below("differing bits", double(different_bits(image, expected)), 0.0);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "nothing behind opacity 1 changes a bit")
{
    const auto behind = [](uint32_t seed) {
        TestVolume volume = noise_volume({16, 16, 16}, seed);
        for (size_t i = 0; i < volume.voxels.size(); ++i)
            if (i % 16 < 5) volume.voxels[i] = 60000.0;
        return volume;
    };
    Session session =
        plain_session({{0.0, RED, 0.1}, {50000.0, RED, 0.3}, {55000.0, BLUE, 1.0}, {65535.0, BLUE, 1.0}}, {16, 16});
    session.render.background = {0.0, 0.0, 0.0, 0.0};
    const auto pictures = [&](uint32_t seed) {
        load(behind(seed));
        // Orthographic rays meet only the plateau; the cut keeps slanted ones from missing it.
        ImageF straight = draw(session, camera_along(volume(), {1, 0, 0}, 12.0));
        ImageF slanted = draw(session, perspective({-30.0, 12.0, 9.0}, {0.0, 8.0, 8.0}, 10.0));
        return std::pair(straight, slanted);
    };
    const auto [straight, slanted] = pictures(2);
    const auto [other_straight, other_slanted] = pictures(3);
    check_below("differing bits", double(different_bits(straight, other_straight)), 0.0);
    check_below("differing bits", double(different_bits(slanted, other_slanted)), 0.0);
    for (const glm::dvec4& pixel : pixels_of(straight)) CHECK(pixel == glm::dvec4(glm::vec4(glm::vec3(BLUE), 1.0f)));
}

TEST_CASE_FIXTURE(OnDevice, "a cut box that holds nothing shows the background")
{
    load(noise_volume({12, 12, 12}, 4));
    const Camera camera = camera_looking("left", volume().info());
    Session session = plain_session(uniform_points(RED, 0.5), {16, 16});
    session.render.background = {0.25, 0.5, 0.75, 1.0};
    const CutBox empty[] = {{.lower = glm::dvec3(4.0), .upper = glm::dvec3(4.0)},
                            {.lower = {0.0, 4.0, 0.0}, .upper = {12.0, 4.0, 12.0}},
                            {.lower = glm::dvec3(12.0), .upper = glm::dvec3(20.0)},
                            {.lower = {12.5, 0.0, 0.0}, .upper = {20.0, 12.0, 12.0}},
                            {.lower = {0.0, 13.0, 0.0}, .upper = {12.0, 20.0, 12.0}}};
    for (const CutBox& cut : empty) {
        session.cut = cut;
        CAPTURE(cut.lower.x);
        CAPTURE(cut.upper.x);
        check_below("off the background",
                    worst_difference(pixels_of(draw(session, camera)), filled(256, {0.25, 0.5, 0.75}, 1.0)), 0.0);
    }
    session.cut = {.lower = glm::dvec3(0.0), .upper = glm::dvec3(12.0)};
    Camera backwards = camera;
    backwards.near_distance = 40.0;
    backwards.far_distance = 30.0;
    check_below("off the background, with near behind far",
                worst_difference(pixels_of(draw(session, backwards)), filled(256, {0.25, 0.5, 0.75}, 1.0)), 0.0);
}

TEST_CASE_FIXTURE(OnDevice, "a ray that ends early loses at most what its limit allows")
{
    load(noise_volume({40, 40, 40}, 5));
    const Camera camera = camera_looking("right", volume().info());
    Session session = plain_session(busy_points(0.6), {24, 24});
    session.render.background = {1.0, 1.0, 1.0, 1.0};
    const Pixels whole = pixels_of(draw(session, camera));
    for (const double limit : {1.0 - 1.0 / 1024, 1.0 - 1.0 / 256, 0.9, 0.5}) {
        session.render.opacity_limit = limit;
        const double loss = worst_difference(pixels_of(draw(session, camera)), whole);
        check_below("loss", loss, 1.0 - limit + ROUNDING);
        CHECK(loss > 0.0);
        reference::DiscreteOptions stepped = tabulated(volume(), session);
        stepped.stop_opacity = limit;
        // Rounding may move the end of a ray that is within an ulp of the limit by one sample: not here.
        check_below("discrete", worst_difference(pixels_of(draw(session, camera)), expected(session, camera, stepped)),
                    2e-5);
    }
}

TEST_CASE_FIXTURE(OnDevice, "clip planes end the slab where they stand")
{
    load(constant_volume({20, 20, 20}, 30000.0));
    Session session = opacity_session(0.1);
    Camera camera = camera_along(volume(), {0, 1, 0}, 8.0);
    const double front_face = glm::distance(camera.eye, camera.target) - 10.0;
    const auto check_length = [&](double near, double far, double length) {
        CAPTURE(near);
        CAPTURE(far);
        camera.near_distance = near;
        camera.far_distance = far;
        const double opacity = opacity_of_depth(length * depth_of_opacity(0.1));
        check_below("clipped",
                    worst_difference(pixels_of(draw(session, camera)), filled(16, glm::dvec3(opacity), opacity)),
                    CLOSED_FORM);
    };
    check_length(0.0, 0.0, 20.0);
    check_length(front_face + 3.25, 0.0, 16.75);
    check_length(0.0, front_face + 4.1, 4.1);
    check_length(front_face + 5.0, front_face + 5.3, 0.3);
    check_length(front_face + 40.0, 0.0, 0.0);
    check_length(0.0, front_face - 1.0, 0.0);
    check_length(front_face + 7.0, front_face + 6.0, 0.0);
}

TEST_CASE_FIXTURE(OnDevice, "a thin shell at grazing angles is as thick as it looks")
{
    load(constant_volume({64, 64, 1}, 30000.0));
    Session session = opacity_session(0.05);
    for (const double degrees : {0.0, 45.0, 60.0, 80.0, 88.0, 89.9, 90.0}) {
        CAPTURE(degrees);
        const double angle = glm::radians(degrees);
        const Camera camera = camera_along(volume(), {std::sin(angle), 0.0, -std::cos(angle)}, 0.01);
        const double length = std::min(1.0 / std::max(std::cos(angle), 1e-9), 64.0 / std::max(std::sin(angle), 1e-9));
        const double opacity = opacity_of_depth(length * depth_of_opacity(0.05));
        const Pixels pixels = pixels_of(draw(session, camera));
        if (degrees < 89.0 || degrees == 90.0)
            check_below("closed form", worst_difference(pixels, filled(16, glm::dvec3(opacity), opacity)), CLOSED_FORM);
        // Rays that enter through a rim: float positions are 4e-6 voxel apart, and 1 / cos is 573.
        check_below("discrete", worst_difference(pixels, discrete(session, camera)), 2e-5);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a spike of the transfer function is seen by every step that meets it")
{
    load(volume_of({32, 8, 8}, [](const glm::dvec3& p) { return 2000.0 * p.x; }));
    const double middle = 30000.0, half_width = 65535.0 / 512;
    Session session = plain_session({{0.0, RED, 0.0},
                                     {middle - half_width, RED, 0.0},
                                     {middle, GREEN, 0.9},
                                     {middle + half_width, BLUE, 0.0},
                                     {65535.0, BLUE, 0.0}});
    const Camera camera = camera_along(volume(), {1, 0.1, 0.05}, 5.0);
    for (const double step : {0.5, 0.0625, 0.0078125}) {
        CAPTURE(step);
        session.render.step_voxels = step;
        // Positions in float are 2e-6 voxel apart: 4e-3 codes, on slopes of 0.9 in 128 codes.
        check_below("discrete", error(session, camera), 5e-5);
    }
}

TEST_CASE_FIXTURE(OnDevice, "the picture converges to the integral with order 2")
{
    load(volume_of({48, 48, 48}, [](const glm::dvec3& p) {
        const glm::dvec3 from_middle = p - glm::dvec3(23.0, 24.5, 25.0);
        return 60000.0 * std::exp(-glm::dot(from_middle, from_middle) / (2.0 * 9.0 * 9.0));
    }));
    Session session = plain_session({{0.0, RED, 0.0}, {65535.0, BLUE, 0.12}});
    const Camera camera = camera_along(volume(), {0.7, 0.5, 0.3}, 20.0);
    const Pixels truth = expected(session, camera, reference::ExactOptions{});
    std::vector<double> steps, errors;
    for (double step = 4.0; step > 0.1; step *= 0.5) {
        session.render.step_voxels = step;
        steps.push_back(step);
        errors.push_back(rms_difference(pixels_of(draw(session, camera)), truth));
    }
    INFO("rms at steps of 4 and 0.125: ", errors.front(), ", ", errors.back());
    CHECK(steps.size() == 6);
    check_below("order of convergence, below 2", std::max(2.0 - observed_order(steps, errors), 0.0), 0.2);
    check_below("rms at a step of 0.125", errors.back(), 1e-5);
}

TEST_CASE_FIXTURE(OnDevice, "the background is premultiplied by its alpha and seen through what covers it")
{
    load(constant_volume({10, 8, 8}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 16.0);
    Session session = plain_session(uniform_points(RED, opacity_of_depth(0.1)), {4, 4});
    for (const double alpha : {0.0, 0.25, 1.0}) {
        CAPTURE(alpha);
        session.render.background = {0.2, 0.9, 0.4, alpha};
        const Pixels pixels = pixels_of(draw(session, camera));
        const double through = std::exp(-1.0) * alpha;
        const glm::dvec4 covered(RED * opacity_of_depth(1.0) + through * glm::dvec3(0.2, 0.9, 0.4),
                                 opacity_of_depth(1.0) + through);
        const glm::dvec4 bare = glm::dvec4(glm::dvec3(0.2, 0.9, 0.4) * alpha, alpha);
        check_below("covered", worst_difference({pixels[5]}, {covered}), ROUNDING);
        check_below("bare", worst_difference({pixels[0]}, {bare}), 1e-7);
        check_below("discrete", worst_difference(pixels, discrete(session, camera)), ROUNDING);
    }
}

TEST_CASE_FIXTURE(OnDevice, "every type of voxel is drawn at its own intensities")
{
    const std::pair<VoxelType, glm::dvec2> types[] = {{VoxelType::uint8, {0.0, 255.0}},
                                                      {VoxelType::int8, {-128.0, 127.0}},
                                                      {VoxelType::uint16, {100.0, 4195.0}},
                                                      {VoxelType::int16, {-1024.0, 3071.0}},
                                                      {VoxelType::float32, {-0.5, 2.25}}};
    for (const auto& [type, range] : types) {
        const std::string type_name = name_of(type);  // of a pointer, doctest shows the address
        CAPTURE(type_name);
        const double least = range.x, width = range.y - range.x;
        TestVolume volume = noise_volume({20, 9, 11}, 6);
        volume.type = type;
        volume.minimum = range.x;
        volume.maximum = range.y;
        for (double& voxel : volume.voxels) {
            voxel = least + width * voxel / 65535.0;
            voxel = type == VoxelType::float32 ? double(float(voxel)) : std::round(voxel);
        }
        load(volume);
        Session session = plain_session({{least - width, RED, 0.0},
                                         {least + 0.3 * width, GREEN, 0.05},
                                         {least + 0.6 * width, RED, 0.02},
                                         {least + 1.5 * width, BLUE, 0.3}},
                                        {16, 16});
        session.light.shaded = true;
        check_below("discrete", error(session, camera_looking("top", volume.info())), 2e-5);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a plateau that begins or ends exactly at the intensity of a voxel is drawn")
{
    for (int value = 0; value < 256; ++value) {
        CAPTURE(value);
        TestVolume volume = constant_volume({4, 4, 4}, value);
        volume.type = VoxelType::uint8;
        volume.maximum = 255.0;
        load(volume);
        const Camera camera = camera_along(volume, {1, 0, 0}, 2.0);
        for (const double other : {-1000.0, -1.0, -0.1, 0.1, 1.0, 1000.0}) {
            CAPTURE(other);
            const Session session = plain_session({{double(value), WHITE, 1.0}, {value + other, WHITE, 1.0}}, {1, 1});
            check_below("off opaque white", worst_difference(pixels_of(draw(session, camera)), filled(1, WHITE, 1.0)),
                        0.0);
        }
    }
}
