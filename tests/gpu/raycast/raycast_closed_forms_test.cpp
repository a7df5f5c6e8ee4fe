// Media whose depth has a closed form, though opacity changes from voxel to voxel: the remaining error is that of
// trilinear interpolation, of order 2 in the size of a voxel. And parts of a volume that make up the whole.

#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/constants.hpp>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr double FULL = 65535.0;

/// Opacity for a voxel's length is the voxel's share of all codes; the picture's alpha tells the depth.
Session depth_session(const glm::uvec2& pixels)
{
    Session session = plain_session({{0.0, WHITE, 0.0}, {FULL, WHITE, 1.0}}, pixels);
    session.render.background = glm::dvec4(0.0);
    session.render.step_voxels = 0.25;
    return session;
}

/// The order at which errors fall while a feature becomes twice as large from one to the next.
double order_of(const std::vector<double>& errors)
{
    return std::log2(errors.front() / errors.back()) / double(errors.size() - 1);
}

/// 1 - the product of what boxes let through, of which the nearest is first or last: it does not matter.
double opacity_behind(const std::vector<double>& opacities)
{
    double through = 1.0;
    for (const double opacity : opacities) through *= 1.0 - opacity;
    return 1.0 - through;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "a Gaussian blob has its closed depth, with order 2 in its width")
{
    constexpr double TOP = 0.04;  // opacity in the middle
    std::vector<double> errors;
    for (const double width : {4.0, 8.0, 16.0}) {
        const int side = int(9.0 * width);
        const glm::dvec3 middle(0.5 * side);
        load(volume_of(glm::ivec3(side), [&](const glm::dvec3& p) {
            const glm::dvec3 off = (p - middle) / width;
            return FULL * TOP * std::exp(-0.5 * glm::dot(off, off));
        }));
        // One ray, through the middle and along an axis. -ln(1 - a) is the sum of a^k / k, and each power of a Gaussian
        // is a narrower one.
        double depth = 0.0;
        for (int k = 1; k < 20; ++k)
            depth += std::pow(TOP, k) / k * std::sqrt(glm::two_pi<double>() / k) * width *
                     std::erf(4.5 * std::sqrt(0.5 * k));
        Session session = depth_session({1, 1});
        Camera camera = camera_along(volume(), {1, 0, 0}, 1.0);
        const double found = depth_of_opacity(pixels_of(draw(session, camera))[0].a);
        CAPTURE(width);
        errors.push_back(std::abs(found / depth - 1.0));
        check_below("depth, relative", errors.back(), 0.5 / (width * width));
    }
    check_below("order of convergence, below 2", std::max(2.0 - order_of(errors), 0.0), 0.2);
}

// Kind (Light): steps below 0.001 voxels, of which a ray sums hundreds of thousands
TEST_CASE_FIXTURE(OnDevice, "the shortest steps sum to what long ones do")
{
    constexpr double OPACITY = 0.5;  // of a voxel's length: plain sums would be 4e-4 off
    load(constant_volume({16, 16, 16}, 40000.0));
    Session session = plain_session(uniform_points(WHITE, OPACITY), {1, 1});
    session.render.background = glm::dvec4(0.0);
    session.render.opacity_limit = 1.0;
    const Camera camera = camera_along(volume(), {1, 0, 0}, 1.0);
    const double expected = 1.0 - std::pow(1.0 - OPACITY, 16.0);
    for (const double step : {0.01, 0.001, 0.0001}) {
        CAPTURE(step);
        session.render.step_voxels = step;
        const glm::dvec4 found = pixels_of(draw(session, camera))[0];
        check_below("opacity of many steps", std::abs(found.a - expected), 1e-6);
        check_below("colour of many steps", std::abs(found.r - expected), 1e-6);
    }
}

TEST_CASE_FIXTURE(OnDevice, "an exponential medium has its closed depth, with order 2 in its height")
{
    constexpr double DEPTH = 0.05;  // of a voxel's length at z = 0
    std::vector<double> errors;
    for (const double height : {4.0, 8.0, 16.0}) {
        const int side = int(6.0 * height);
        load(volume_of({4, 4, side},
                       [&](const glm::dvec3& p) { return FULL * opacity_of_depth(DEPTH * std::exp(-p.z / height)); }));
        Session session = depth_session({1, 1});
        // Between middles of voxels, so that no border is repeated.
        session.cut = {{0.0, 0.0, 0.5}, {4.0, 4.0, side - 0.5}};
        const double depth = DEPTH * height * (std::exp(-0.5 / height) - std::exp(-(side - 0.5) / height));
        const double found = depth_of_opacity(pixels_of(draw(session, camera_along(volume(), {0, 0, 1}, 1.0)))[0].a);
        CAPTURE(height);
        errors.push_back(std::abs(found / depth - 1.0));
        check_below("depth, relative", errors.back(), 0.25 / (height * height));
    }
    check_below("order of convergence, below 2", std::max(2.0 - order_of(errors), 0.0), 0.2);
}

TEST_CASE_FIXTURE(OnDevice,
                  "eight boxes of a volume let through together what the whole lets through: no crack, nothing twice")
{
    load(constant_volume({24, 20, 28}, 30000.0));
    Session session = plain_session(uniform_points(WHITE, 0.03), {24, 24});
    session.render.background = glm::dvec4(0.0);
    for (const glm::dvec3& at :
         {glm::dvec3(12.0, 10.0, 14.0), glm::dvec3(7.3, 11.9, 20.25), glm::dvec3(1.0, 19.5, 3.001)})
        for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(0.2, 1, -0.7), glm::dvec3(1, 1, 1)}) {
            const Camera camera = camera_along(volume(), direction, 40.0);
            session.cut = {glm::dvec3(0.0), glm::dvec3(24.0, 20.0, 28.0)};
            const Pixels whole = pixels_of(draw(session, camera));
            std::vector<std::vector<double>> parts(whole.size());
            for (int box = 0; box < 8; ++box) {
                const glm::bvec3 upper(box & 1, box & 2, box & 4);
                session.cut = {glm::mix(glm::dvec3(0.0), at, upper), glm::mix(at, glm::dvec3(24.0, 20.0, 28.0), upper)};
                const Pixels part = pixels_of(draw(session, camera));
                for (size_t i = 0; i < part.size(); ++i) parts[i].push_back(part[i].a);
            }
            double worst = 0.0, most = 0.0;
            for (size_t i = 0; i < whole.size(); ++i) {
                worst = std::max(worst, std::abs(opacity_behind(parts[i]) - whole[i].a));
                most = std::max(most, whole[i].a);
            }
            CAPTURE(at.x);
            CAPTURE(direction.y);
            check_below("opacity", worst, 2e-6);
            CHECK(most > 0.4);
        }
}

TEST_CASE_FIXTURE(OnDevice, "an opaque last voxel is met by the last sample, and nothing of the background is left")
{
    for (const double step : {1.0, 0.5, 0.3}) {
        load(volume_of({12, 4, 4}, [](const glm::dvec3& p) { return p.x > 11.0 ? 60000.0 : 20000.0; }));
        Session session =
            plain_session({{0.0, RED, 0.05}, {30000.0, RED, 0.05}, {59000.0, BLUE, 1.0}, {FULL, BLUE, 1.0}}, {4, 4});
        session.render.step_voxels = step;
        const Camera camera = camera_along(volume(), {1, 0, 0}, 2.0);
        session.render.background = {1.0, 1.0, 1.0, 1.0};
        const ImageF white = draw(session, camera);
        session.render.background = {0.0, 0.0, 0.0, 1.0};
        const ImageF black = draw(session, camera);
        CAPTURE(step);
        check_below("differing bits", double(different_bits(white, black)), 0.0);
        check_below("discrete", error(session, camera), 2e-6);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a picture that is drawn again, after others and loaded anew, has the same bits")
{
    Session session = plain_session(busy_points(), {45, 38});
    session.light.shaded = true;
    std::optional<ImageF> first;
    for (int i = 0; i < 6; ++i) {
        if (i % 2 == 0) load(noise_volume({40, 33, 50}, 6));
        const Camera camera = camera_along(volume(), {3, 2, 1}, 60.0);
        const ImageF image = draw(session, camera);
        if (!first) first = image;
        check_below("differing bits", double(different_bits(image, *first)), 0.0);
        draw(session, camera_along(volume(), {1, double(i), 0.5}, 30.0));
    }
}
