// How exactly the device draws a transfer function: steps of it, parts of a ray's step, densities at which rays end.

#include <cmath>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A device's rounding of densities and positions, where opacities are high.
constexpr double ROUNDING = 3e-6;

Session clear(std::vector<ControlPoint> points, double step, const glm::uvec2& pixels)
{
    Session session = plain_session(std::move(points), pixels);
    session.render.background = glm::dvec4(0.0);
    session.render.step_voxels = step;
    return session;
}

std::vector<ControlPoint> step_at(double code, double reach)
{
    return {{-reach, WHITE, 0.0}, {code, WHITE, 0.0}, {code, WHITE, 0.6}, {65535.0 + reach, WHITE, 0.6}};
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "the last part of a ray is as opaque as it is long, however opaque a whole step is")
{
    load(constant_volume({40, 4, 4}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    struct Case {
        double step, opacity;
    };
    for (const auto& [step, opacity] :
         {Case{3.0, 0.997}, {8.0, 0.9}, {1.0, 1.0 - 1e-7}, {1.0, 1.0 - 1e-12}, {20.0, 0.6}, {0.5, 0.9}, {30.0, 1.0}})
        for (const double rest : {1e-4, 0.02, 0.3, 0.77}) {
            CAPTURE(step);
            CAPTURE(opacity);
            CAPTURE(rest);
            Session session = clear(uniform_points(WHITE, opacity), step, {4, 4});
            session.cut = {.lower = {2.0, 0.0, 0.0}, .upper = {2.0 + rest * step, 4.0, 4.0}};
            const double seen = opacity == 1.0 ? 1.0 : opacity_of_depth(rest * step * depth_of_opacity(opacity));
            const Pixels expected(16, glm::dvec4(seen));
            // The cut is a float: 2^-22 of 40 voxels, and as much again of the length.
            const double bound = 1e-6 + 1e-6 * depth_of_opacity(std::min(opacity, 1.0 - 1e-16));
            check_below("plain", worst_difference(pixels_of(draw(session, camera)), expected), bound);
            if (step > 1.0) continue;
            session.render.preintegration = true;
            check_below("pre-integrated", worst_difference(pixels_of(draw(session, camera)), expected), bound);
        }
}

TEST_CASE_FIXTURE(OnDevice, "the last part of a ray through paint is as opaque as it is long")
{
    load(constant_volume({40, 4, 4}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 3.0);
    Session session = clear(unseen_points(), 8.0, {4, 4});
    session.groups[7] = GroupSettings{.name = {}, .color = WHITE, .opacity = 0.9};
    Annotator annotator(renderer());
    REQUIRE(annotator.paint({.brush = Brush::fill, .group = 7, .radius_voxels = 30.0, .path = {{20, 2, 2}}}) == 640);
    for (const double rest : {0.02, 0.3}) {
        session.cut = {.lower = {2.0, 0.0, 0.0}, .upper = {2.0 + rest * 8.0, 4.0, 4.0}};
        const double seen = opacity_of_depth(rest * 8.0 * depth_of_opacity(0.9));
        check_below("paint", worst_difference(pixels_of(draw(session, camera)), Pixels(16, glm::dvec4(seen))), 4e-6);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a step inside a wide function is as sharp as the codes are")
{
    load(noise_volume({24, 24, 24}, 11));
    const Camera camera = camera_along(volume(), {0.7, 0.5, 0.3}, 20.0);
    for (const double reach : {0.0, 1e3, 1e9})
        for (const double code : {31000.0, 31000.5, 47123.9}) {
            CAPTURE(reach);
            CAPTURE(code);
            const Pixels seen = pixels_of(draw(clear(step_at(code, reach), 0.5, {48, 48}), camera));
            // Opacity grows with the density: a step up to one code early, and not at all late.
            const auto exactly = [&](double at) {
                const Session session = clear(step_at(at, 0.0), 0.5, {48, 48});
                return expected(session, camera, reference::DiscreteOptions{.step = 0.5});
            };
            const Pixels least = exactly(code + 0.05), most = exactly(code - 1.05);
            double outside = 0.0;
            for (size_t i = 0; i < seen.size(); ++i)
                outside = std::max({outside, least[i].a - seen[i].a, seen[i].a - most[i].a});
            check_below("within a code", outside, ROUNDING);
            // Samples with densities of whole codes meet the function itself.
            check_below("on average", rms_difference(seen, exactly(code)), 4e-3);
        }
}

TEST_CASE_FIXTURE(OnDevice, "at whole codes a step is exact")
{
    load(volume_of({64, 8, 8}, [](const glm::dvec3& p) { return std::floor(p.x) < 30.0 ? 30999.0 : 31000.0; }));
    // Along y and z densities do not change: all samples have a voxel's own.
    const Camera camera = camera_along(volume(), {0, 1, 0}, 8.0);
    const Session session = clear(step_at(31000.0, 500.0), 0.5, {64, 8});
    Camera centred = camera;
    centred.height = 8.0;
    const Pixels seen = pixels_of(draw(session, centred));
    check_below("discrete", worst_difference(seen, expected(session, centred, reference::DiscreteOptions{.step = 0.5})),
                0.61);
    size_t between = 0;
    for (const glm::dvec4& pixel : seen)
        between += pixel.a > 1e-6 && pixel.a < opacity_of_depth(8 * depth_of_opacity(0.6)) - 1e-5;
    CHECK(between == 0);
}
