// Values, gradients and light. Whole pictures are compared with the reference's shading. Single values and normals are
// read from special pictures: an opaque medium shows only its first sample, whose position a cut determines; its colour
// is then the value, or the cosine between normal and light.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/reference/field.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Exact sampling against double precision: values, and gradients that are not small.
constexpr double VALUES = 2e-6;
constexpr double NORMALS = 1e-4;
/// Shaded pictures: the light on a sample amplifies the rounding of positions and of small gradients.
constexpr double SHADED_RMS = 1e-5;
constexpr double SHADED_WORST = 2e-4;
constexpr double ONE_LEVEL = 1.0 / 255.0;

Session shaded_session(std::vector<ControlPoint> points, const glm::uvec2& pixels)
{
    Session session = plain_session(std::move(points), pixels);
    session.light.shaded = true;
    return session;
}

/// The colour of the first sample.
Session opaque_session(const glm::dvec3& lower, const glm::dvec3& upper, const glm::uvec2& pixels)
{
    return plain_session({{0.0, lower, 1.0}, {65535.0, upper, 1.0}}, pixels);
}

/// Deterministic, and smooth: a few waves per volume.
TestVolume waves(const glm::ivec3& size)
{
    return volume_of(size, [](const glm::dvec3& p) {
        return 32000.0 + 9000.0 * std::sin(0.35 * p.x + 0.1 * p.y) + 9000.0 * std::sin(0.29 * p.y - 0.2 * p.z) +
               9000.0 * std::cos(0.4 * p.z + 0.15 * p.x + 1.0);
    });
}

/// Marschner and Lobb 1994, f_M = 6, alpha = 0.25; `p` in [-1, 1]^3.
double marschner_lobb(const glm::dvec3& p)
{
    const double pi = std::numbers::pi, frequency = 6.0, alpha = 0.25;
    const double rho = std::cos(2.0 * pi * frequency * std::cos(0.5 * pi * std::hypot(p.x, p.y)));
    return (1.0 - std::sin(0.5 * pi * p.z) + alpha * (1.0 + rho)) / (2.0 * (1.0 + alpha));
}

glm::dvec3 marschner_lobb_gradient(const glm::dvec3& p)
{
    constexpr double H = 1e-6;
    glm::dvec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 h(0.0);
        h[axis] = H;
        gradient[axis] = (marschner_lobb(p + h) - marschner_lobb(p - h)) / (2.0 * H);
    }
    return gradient;
}

TestVolume marschner_lobb_volume(int side)
{
    return volume_of(glm::ivec3(side), [&](const glm::dvec3& voxel) {
        return 65535.0 * marschner_lobb(2.0 * voxel / double(side) - 1.0);
    });
}

/// A picture whose pixel (x, y) samples the volume at `at(x, y)`: looking down the z axis onto a cut.
struct Slice {
    double z;
    glm::uvec2 pixels;
    Camera camera;

    Slice(const TestVolume& volume, double depth, const glm::uvec2& counts, double height)
        : z(depth), pixels(counts), camera(camera_along(volume, {0, 0, 1}, height))
    {}
    Session cut(Session session) const
    {
        session.cut.lower.z = z;
        session.render.step_voxels = STEP;
        return session;
    }
    /// The rays as the reference computes them.
    std::vector<glm::dvec3> positions(const TestVolume& volume, const Session& session) const
    {
        std::vector<glm::dvec3> positions;
        for (const reference::Ray& ray : rays_of(volume, session, camera))
            positions.emplace_back(ray.origin.x, ray.origin.y, z + 0.5 * STEP);
        return positions;
    }
    static constexpr double STEP = 1.0 / 1024;
};

/// Unit normals of the first samples: from six pictures, each lit along a single axis.
std::vector<glm::dvec3> normals_on(OnDevice& device, const Slice& slice)
{
    Session session = slice.cut(opaque_session(WHITE, WHITE, slice.pixels));
    session.light = {.shaded = true, .ambient = 0.0, .diffuse = 1.0, .specular = 0.0, .gradient_fade = 0.0};
    const glm::dvec3 back = glm::normalize(slice.camera.eye - slice.camera.target);
    const glm::dvec3 right = glm::cross(slice.camera.up, back);
    std::vector<glm::dvec3> normals(size_t(slice.pixels.x) * slice.pixels.y, glm::dvec3(0.0));
    for (int i = 0; i < 6; ++i) {
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        glm::dvec3 axis(0.0);
        axis[i / 2] = sign;
        session.light.direction = {glm::dot(axis, right), glm::dot(axis, slice.camera.up), glm::dot(axis, back)};
        const Pixels pixels = pixels_of(device.draw(session, slice.camera));
        for (size_t k = 0; k < pixels.size(); ++k) normals[k][i / 2] += sign * pixels[k].r;
    }
    return normals;
}

/// Without acos, which loses small angles.
double degrees_between(const glm::dvec3& a, const glm::dvec3& b)
{
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

double root_mean_square(const std::vector<double>& values)
{
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / double(values.size()));
}

void check_percent(const std::string& what, double value, double expected, double percent)
{
    CAPTURE(value);
    CAPTURE(expected);
    check_below(what + " off by per cent", 100.0 * std::abs(value / expected - 1.0), percent);
}

void check_shaded(OnDevice& device, const Session& session, const Camera& camera)
{
    const Pixels pixels = pixels_of(device.draw(session, camera)), truth = device.discrete(session, camera);
    check_below("rms", rms_difference(pixels, truth), SHADED_RMS);
    check_below("worst", worst_difference(pixels, truth), SHADED_WORST);
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "shaded pictures are those of the reference")
{
    const Light lights[] = {{},
                            {.ambient = 0.0, .diffuse = 1.0, .specular = 0.0},
                            {.ambient = 0.1, .diffuse = 0.5, .specular = 0.9, .shininess = 4.0},
                            {.specular = 0.5, .shininess = 0.0},
                            {.specular = 0.5, .shininess = 200.0, .direction = {-1.0, 0.2, 0.3}},
                            {.ambient = 0.6, .diffuse = 1.0, .specular = 1.0},
                            {.direction = {0.0, 0.0, -1.0}},
                            {.gradient_fade = 0.3}};
    load(waves({40, 37, 35}));
    for (const Light& light : lights) {
        CAPTURE(&light - lights);
        Session session = shaded_session(busy_points(), {24, 24});
        session.light = light;
        for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(-0.5, 1, 0.7)})
            check_shaded(*this, session, camera_along(volume(), direction, 50.0));
        const Camera inside = perspective({20.0, 18.0, 16.0}, {0.0, 1.0, 3.0}, 90.0);
        check_shaded(*this, session, inside);
    }
}

TEST_CASE_FIXTURE(OnDevice, "noise is shaded as the reference shades it")
{
    load(noise_volume({33, 34, 35}, 41));
    const Session session = shaded_session(busy_points(0.1), {32, 32});
    for (const char* side : {"front", "back", "left", "right", "top", "bottom"})
        check_shaded(*this, session, camera_looking(side, volume().info()));
}

TEST_CASE_FIXTURE(OnDevice, "gradients are per physical length, whatever the voxels' proportions")
{
    for (const glm::dvec3& spacing : {glm::dvec3(1, 1, 5), glm::dvec3(0.957, 0.957, 1.5), glm::dvec3(3, 1, 2)}) {
        TestVolume volume = waves({36, 30, 20});
        volume.spacing = spacing;
        load(volume);
        const double extent = glm::length(glm::dvec3(volume.size) * spacing);
        const Session session = shaded_session(busy_points(), {24, 24});
        for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(0, -1, 0.2)})
            check_shaded(*this, session, camera_along(volume, direction, 0.8 * extent));

        // A plane whose physical normal is known: f rises by 900 per unit along (1, 2, 2) / 3.
        TestVolume plane = volume_of(
            {24, 24, 24}, [&](const glm::dvec3& p) { return 300.0 * glm::dot(p * spacing, glm::dvec3(1, 2, 2)); });
        plane.spacing = spacing;
        load(plane);
        const Slice slice(plane, 11.3, {8, 8}, 10.0 * spacing.y);
        for (const glm::dvec3& normal : normals_on(*this, slice))
            // Codes are integers: an error of half a code in 300.
            check_below("degrees", degrees_between(normal, glm::dvec3(-1, -2, -2)), 0.3);
    }
}

TEST_CASE_FIXTURE(OnDevice, "the gradient inside a voxel is the derivative of its interpolation, by eight codes")
{
    TestVolume smooth = waves({40, 37, 35}), flat = noise_volume({33, 34, 35}, 41);
    flat.spacing = {0.957, 0.957, 1.5};
    for (const TestVolume& each : {smooth, flat})
        for (const Paging paging : {Paging::never, Paging::always}) {
            CAPTURE(int(paging));
            Session session = shaded_session(busy_points(0.1), {24, 24});
            session.render.paging = paging;
            session.render.detail = 0.0;
            load(each);
            renderer().load(source_of(each), {.minimum = each.minimum, .maximum = each.maximum}, session.render);
            const Camera camera = camera_along(volume(), {-0.5, 1, 0.7}, 60.0);
            const Pixels smoothed = pixels_of(draw(session, camera));
            session.render.gradient = Gradient::analytic;
            check_shaded(*this, session, camera);
            CHECK(rms_difference(pixels_of(draw(session, camera)), smoothed) > 1e-3);  // not the same derivative
            Session unshaded = session;
            unshaded.light.shaded = false;
            const uint64_t reads = work(session, camera)[gpu::COUNTER_DENSITY_READS];
            CHECK(reads == work(unshaded, camera)[gpu::COUNTER_DENSITY_READS]);
            session.render.gradient = Gradient::central;
            CHECK(double(reads) < 0.7 * double(work(session, camera)[gpu::COUNTER_DENSITY_READS]));
        }
}

TEST_CASE_FIXTURE(OnDevice, "Marschner-Lobb is reconstructed as well as trilinear values and half-voxel differences do")
{
    for (const auto& [side, measured_value, measured_degrees] : {std::tuple(64, 1.6e-2, 9.3), {128, 4.2e-3, 1.72}}) {
        CAPTURE(side);
        load(marschner_lobb_volume(side));
        std::vector<double> value_errors, angles, reference_value_errors, reference_angles;
        double worst_value = 0.0, worst_normal = 0.0;
        std::mt19937 random(42);  // seed 42
        for (int i = 0; i < 8; ++i) {
            // Slices at random depths, away from the borders; pixels cover all fractions of a voxel.
            const double depth = side * (0.04 + 0.92 * double(random()) / 4294967296.0);
            const Slice slice(volume(), depth, {53, 53}, 0.92 * side);
            const Session session = slice.cut(opaque_session(glm::dvec3(0.0), WHITE, slice.pixels));
            const Pixels values = pixels_of(draw(session, slice.camera));
            const std::vector<glm::dvec3> normals = normals_on(*this, slice);
            const std::vector<glm::dvec3> positions = slice.positions(volume(), session);
            const reference::Scene scene = scene_of(volume(), session, slice.camera);
            for (size_t k = 0; k < positions.size(); ++k) {
                const glm::dvec3 p = 2.0 * positions[k] / double(side) - 1.0;
                const double value = reference::density_at(scene, positions[k]);
                const glm::dvec3 gradient = reference::gradient_at(scene, positions[k]);
                worst_value = std::max(worst_value, std::abs(values[k].r - value));
                value_errors.push_back(values[k].r - marschner_lobb(p));
                reference_value_errors.push_back(value - marschner_lobb(p));
                angles.push_back(degrees_between(normals[k], -marschner_lobb_gradient(p)));
                reference_angles.push_back(degrees_between(gradient, marschner_lobb_gradient(p)));
                // Positions in float are 4e-6 voxel off, which rotates normals where the gradient is small.
                if (glm::length(gradient) > 0.02)
                    worst_normal = std::max(worst_normal, glm::distance(normals[k], -glm::normalize(gradient)));
            }
        }
        check_below("value against the reference", worst_value, VALUES);
        check_below("normal against the reference", worst_normal, NORMALS);
        check_percent("values", root_mean_square(value_errors), root_mean_square(reference_value_errors), 0.1);
        check_percent("angles", root_mean_square(angles), root_mean_square(reference_angles), 0.1);
        // Published numbers are for "interior points"; the choice of where those end changes them by some per cent.
        check_percent("values as measured", root_mean_square(value_errors), measured_value, 10.0);
        check_percent("angles as measured", root_mean_square(angles), measured_degrees, 10.0);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a radial ramp is shaded as a sphere")
{
    constexpr double RADIUS = 24.0, SURFACE = 40000.0;
    load(volume_of({64, 64, 64}, [](const glm::dvec3& p) {
        return std::max(SURFACE + 1000.0 * (RADIUS - glm::distance(p, glm::dvec3(32.0))), 0.0);
    }));
    Session session = shaded_session({{SURFACE, WHITE, 1.0}, {65535.0, WHITE, 1.0}}, {96, 96});
    session.render.step_voxels = 0.05;
    session.light = {.ambient = 0.2,
                     .diffuse = 0.5,
                     .specular = 0.3,
                     .shininess = 20.0,
                     .direction = {0.0, 0.0, 1.0},
                     .gradient_fade = 0.0};
    for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(0.5, -0.7, 0.6)}) {
        const Pixels pixels = pixels_of(draw(session, camera_along(volume(), direction, 56.0)));
        std::vector<double> errors;
        for (size_t i = 0; i < pixels.size(); ++i) {
            const double x = (double(i % 96) - 47.5) * 56.0 / 96, y = (double(i / 96) - 47.5) * 56.0 / 96;
            const double cosine = std::sqrt(std::max(1.0 - (x * x + y * y) / (RADIUS * RADIUS), 0.0));
            if (cosine > 0.2) errors.push_back(pixels[i].r - (0.2 + 0.5 * cosine + 0.3 * std::pow(cosine, 20.0)));
            if (std::hypot(x, y) > RADIUS + 0.1) CHECK(pixels[i].r == 0.0);
        }
        CHECK(errors.size() > 4000);
        check_below("rms", root_mean_square(errors), 2.0 * ONE_LEVEL);
    }
}

TEST_CASE_FIXTURE(OnDevice, "where nothing changes there is no surface: ambient and diffuse light in full")
{
    load(constant_volume({20, 20, 20}, 30000.0));
    Session session = shaded_session(uniform_points(RED, 0.1), {16, 16});
    const Camera camera = camera_looking("front", volume().info());
    Session unshaded = session;
    unshaded.light.shaded = false;
    const Pixels bare = pixels_of(draw(unshaded, camera));
    for (const double fade : {0.03, 0.0}) {
        session.light = {.ambient = 0.3, .diffuse = 0.5, .specular = 0.8, .gradient_fade = fade};
        Pixels expected = bare;
        for (glm::dvec4& pixel : expected) pixel = glm::dvec4(0.8 * glm::dvec3(pixel), pixel.a);
        check_below("dimmed", worst_difference(pixels_of(draw(session, camera)), expected), VALUES);
        session.light = {.specular = 0.8, .gradient_fade = fade};  // ambient + diffuse = 1
        check_below("as it is", worst_difference(pixels_of(draw(session, camera)), bare), VALUES);
    }
}

TEST_CASE_FIXTURE(OnDevice, "noise of the lowest bit does not sparkle")
{
    std::mt19937 random(43);
    for (const auto& [type, largest] : {std::pair(VoxelType::uint8, 255.0), {VoxelType::uint16, 4095.0}}) {
        const std::string type_name = name_of(type);  // of a pointer, doctest shows the address
        CAPTURE(type_name);
        const double middle = std::floor(0.5 * largest);
        TestVolume volume = volume_of({32, 32, 32}, [&](const glm::dvec3&) { return middle + double(random() % 2); });
        volume.type = type;
        volume.maximum = largest;
        load(volume);
        const Camera camera = camera_looking("front", volume.info());
        for (const double opacity : {0.02, 0.2}) {
            CAPTURE(opacity);
            Session session = shaded_session({{0.0, WHITE, opacity}, {largest, WHITE, opacity}}, {32, 32});
            const Pixels shaded = pixels_of(draw(session, camera));
            session.light.shaded = false;
            const Pixels flat = pixels_of(draw(session, camera));
            check_below("sparkle", worst_difference(shaded, flat), 2.0 * ONE_LEVEL);
        }
    }
}

TEST_CASE_FIXTURE(OnDevice, "over the outermost voxel a ramp's gradient falls to nothing at the face")
{
    load(volume_of({16, 16, 16}, [](const glm::dvec3& p) { return 1000.0 * p.x + 1000.0 * p.z; }));
    // Edge voxels are repeated outside. z continues as in the middle, so the normal turns away from x.
    const Slice slice(volume(), 8.0, {33, 3}, 1.5);
    const std::vector<glm::dvec3> normals = normals_on(*this, slice);
    const std::vector<glm::dvec3> positions =
        slice.positions(volume(), slice.cut(opaque_session(WHITE, WHITE, {33, 3})));
    for (size_t i = 0; i < normals.size(); ++i) {
        const double x = positions[i].x;
        const bool is_outside = x < 0.0 || x > 16.0;
        const double share = std::min({x, 16.0 - x, 1.0});
        const glm::dvec3 expected = is_outside ? glm::dvec3(0.0) : -glm::normalize(glm::dvec3(share, 0.0, 1.0));
        check_below("normal", glm::distance(normals[i], expected), NORMALS);
    }
}

TEST_CASE_FIXTURE(OnDevice, "light from behind leaves a surface in ambient light")
{
    load(volume_of({32, 32, 32}, [](const glm::dvec3& p) { return 2000.0 * p.x; }));
    Session session = shaded_session({{20000.0, WHITE, 1.0}, {65535.0, WHITE, 1.0}}, {8, 8});
    session.light = {.ambient = 0.25, .diffuse = 0.75, .specular = 1.0, .direction = {0.0, 0.0, -1.0}};
    session.light.gradient_fade = 1e-5;
    const Camera camera = camera_along(volume(), {1, 0, 0}, 8.0);
    for (const glm::dvec4& pixel : pixels_of(draw(session, camera))) CHECK(std::abs(pixel.r - 0.25) < 1e-6);
    session.light.direction = {0.0, 0.0, 1.0};
    for (const glm::dvec4& pixel : pixels_of(draw(session, camera))) CHECK(pixel.r == 1.0);
}
