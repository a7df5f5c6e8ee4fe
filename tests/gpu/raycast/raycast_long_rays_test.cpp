// Rays that take more steps than one dispatch draws, and the message about those that stop short.

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr Paging PAGINGS_TRIED[] = {Paging::never, Paging::always};

class LongRays : public OnDevice {
public:
    void load_paged(TestVolume volume, Paging paging)
    {
        VolumeStatistics statistics;
        statistics.minimum = volume.minimum;
        statistics.maximum = volume.maximum;
        load(std::move(volume));
        renderer().load(source_of(this->volume()), statistics, {.sampling = Sampling::exact, .paging = paging});
    }
    Session session_of(double opacity, double step, const glm::uvec2& pixels = {2, 2}) const
    {
        Session session = plain_session(uniform_points(WHITE, opacity), pixels);
        session.render.background = glm::dvec4(0.0);
        session.render.step_voxels = step;
        return session;
    }
};

}  // namespace

TEST_CASE_FIXTURE(LongRays, "a ray of a hundred thousand steps reaches its end")
{
    for (const Paging paging : PAGINGS_TRIED) {
        load_paged(constant_volume({1024, 8, 8}, 30000.0), paging);
        const Camera camera = camera_along(volume(), {1, 0, 0}, 4.0);
        const double opacity = opacity_of_depth(1024 * depth_of_opacity(1e-3));
        const Pixels pixels = pixels_of(draw(session_of(1e-3, 0.01), camera));
        check_below("closed form", worst_difference(pixels, Pixels(4, glm::dvec4(opacity))), 2e-5);
    }
}

TEST_CASE_FIXTURE(LongRays, "a ray through 16000 voxels at the usual step reaches its end")
{
    for (const Paging paging : PAGINGS_TRIED) {
        load_paged(constant_volume({16000, 8, 8}, 30000.0), paging);
        const Camera camera = camera_along(volume(), {1, 0, 0}, 4.0);
        const double opacity = opacity_of_depth(16000 * depth_of_opacity(1e-4));
        const Pixels pixels = pixels_of(draw(session_of(1e-4, 0.5), camera));
        check_below("closed form", worst_difference(pixels, Pixels(4, glm::dvec4(opacity))), 2e-5);
    }
}

TEST_CASE_FIXTURE(LongRays, "what lies far along a ray is seen, picked and hidden as if it were near")
{
    // A wall at 900, which skipping and slow steps reach after many dispatches; nothing behind it is visible.
    for (const Paging paging : PAGINGS_TRIED)
        for (const bool skipping : {true, false}) {
            CAPTURE(skipping);
            load_paged(volume_of({1024, 8, 8}, [](const glm::dvec3& p) { return p.x < 900.0 ? 1000.0 : 50000.0; }),
                       paging);
            const Camera camera = camera_along(volume(), {1, 0, 0}, 4.0);
            Session session = plain_session({{25500.0, RED, 1.0}, {65535.0, RED, 1.0}}, {2, 2});
            session.render.step_voxels = 0.01;
            session.render.skip_empty_space = skipping;
            CHECK(worst_difference(pixels_of(draw(session, camera)), Pixels(4, glm::dvec4(RED, 1.0))) < 1e-6);
            const auto seen = renderer().pick(session.look(), camera, {2, 2}, {0, 0});
            REQUIRE(seen.has_value());
            CHECK(std::abs(seen->point.x - 900.0) < 0.02);
        }
}

TEST_CASE_FIXTURE(LongRays, "surfaces behind, and an iso-surface across the blocks of a long ray")
{
    load_paged(volume_of({1024, 8, 8}, [](const glm::dvec3& p) { return 30000.0 + 20000.0 * std::sin(p.x / 20.0); }),
               Paging::never);
    const Camera camera = camera_along(volume(), {1, 0, 0}, 4.0);
    const auto picture = [&](double step) {
        Session session = session_of(1e-3, step);
        session.light = {.shaded = true, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
        const ProbeLook probe{.center = {512.0, 4.0, 4.0},
                              .radius = 500.0,
                              .color = RED,
                              .ball_share = 0.0,
                              .shell = ShellLook{.threshold = 40000.0, .opacity = 0.02, .is_box = true}};
        return pixels_of(renderer().render(session, camera, {.probe = probe}).image);
    };
    renderer().scene().set_surfaces({{{1000.0, 4.0, 4.0}, {1000.0, 4.0, 4.0}, 6.0, 6.0, BLUE}});
    // Fog of one opacity is the same at any step; 16 periods of 126 voxels make 16 crossings of the threshold.
    check_below("one block and many", worst_difference(picture(0.5), picture(0.01)), 3e-5);
    renderer().scene().set_surfaces({});
}

TEST_CASE_FIXTURE(LongRays, "a ray that cannot be drawn to its end makes the picture incomplete, and is told")
{
    load_paged(constant_volume({64, 8, 8}, 30000.0), Paging::never);
    const Camera camera = camera_along(volume(), {1, 0, 0}, 4.0);
    const Picture picture = renderer().render(session_of(1e-3, 2e-6, {1, 1}), camera);
    CHECK_FALSE(picture.complete);
    REQUIRE(picture.warnings.size() == 1);
    CHECK(picture.warnings[0] ==
          "1 ray stops before its end, because it takes more samples than the device draws; expected a "
          "render.step_voxels above 2e-06, or a smaller box of the cutting planes");
    const Picture whole = renderer().render(session_of(1e-3, 0.01, {1, 1}), camera);
    CHECK(whole.complete);
    CHECK(whole.warnings.empty());
}

TEST_CASE_FIXTURE(LongRays, "the nearest of a hundred thousand surfaces in a row is seen from both ends")
{
    load_paged(constant_volume({8, 8, 8}, 0.0), Paging::never);
    std::vector<SurfaceLook> surfaces;
    for (int i = 0; i < 100000; ++i) {
        const glm::dvec3 from(4.0 + 2.0 * i, 4.0, 4.0);
        surfaces.push_back({from, from, 0.5, 0.5, i == 0 ? RED : i == 99999 ? BLUE : GREEN});
    }
    renderer().scene().set_surfaces(surfaces);
    Session session = plain_session(unseen_points(), {1, 1});
    session.light = {.shaded = false, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    for (const double side : {1.0, -1.0}) {
        Camera camera = camera_along(volume(), {side, 0, 0}, 0.1);
        camera.eye.x = side > 0.0 ? -100.0 : 300000.0;
        camera.far_distance = 600000.0;
        const glm::dvec4 pixel = pixels_of(draw(session, camera))[0];
        CHECK(glm::distance(glm::dvec3(pixel), side > 0.0 ? RED : BLUE) < 1e-5);
    }
    renderer().scene().set_surfaces({});
}
