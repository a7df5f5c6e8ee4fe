// Quality `reference` against the double-precision reference: in the scenes of `shvr bench`, and for narrow peaks.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/gpu/paging/paged_scenes.h"
#include "tests/support/gpu.h"
#include "tests/support/occlusion.h"
#include "tests/support/slow.h"
#include "tools/bench/measure.h"
#include "tools/bench/reference_scene.h"
#include "tools/golden/studio.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr double MAX_RMSE = 1e-4, MAX_RMSE_OF_HALVING = 1e-5;  // linear light

bench::Scene in_quality_reference(bench::Scene scene)
{
    scene.drawn.settings.emplace_back("render.quality=reference");
    return scene;
}

bench::ReferenceScene scene_of(const golden::Studio& studio)
{
    const OpenedSession& opened = studio.opened();
    return bench::reference_scene_of(studio.session(), *opened.source, opened.statistics, studio.camera(),
                                     &studio.document().mask);
}

ImageF truth_of(const golden::Studio& studio, const bench::ReferenceScene& scene)
{
    const OpenedSession& opened = studio.opened();
    const Session& session = studio.session();
    const glm::uvec2 size = session.render.size;
    std::vector<glm::uvec2> pixels;
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) pixels.emplace_back(x, y);
    const std::vector<reference::Ray> rays =
        bench::rays_through(pixels, ray_planes(studio.camera(), size, opened.source->info()));
    ImageF image{int(size.x), int(size.y), {}};
    for (const glm::dvec4& light :
         bench::draw(scene, rays, reference::ExactOptions{.tolerance = 1e-8}, session.render.background, 1))
        for (int channel = 0; channel < 4; ++channel) image.rgba.push_back(float(light[channel]));
    return image;
}

void check_scene(const bench::Scene& scene)
{
    CAPTURE(scene.name);
    golden::Studio studio(scene.drawn, {.device = {}, .validation = true, .budget_device = scene.budget_device});
    const auto drawn = [&](double step) {
        Session session = studio.session();
        session.render.step_voxels = step;
        return studio.picture_of(session, studio.camera(), false).image;
    };
    const double step = studio.session().render.step_voxels;
    const ImageF picture = drawn(step);
    check_below("RMSE", bench::error_of(picture, truth_of(studio, scene_of(studio))).rmse, MAX_RMSE);
    check_below("change by half the step", bench::error_of(drawn(0.5 * step), picture).rmse, MAX_RMSE_OF_HALVING);
    CHECK(studio.take_validation_messages() == std::vector<std::string>{});
}

/// `count` peaks, each a hundredth of the range wide at its foot, of varied colours.
std::vector<ControlPoint> narrow_peaks(int count)
{
    std::vector<ControlPoint> points;
    for (int i = 0; i < count; ++i) {
        const double middle = 65535.0 * (i + 0.5) / count, half_width = 65535.0 / 200.0;
        const glm::dvec3 color(0.5 + 0.5 * std::sin(i), 0.5 + 0.5 * std::sin(2.0 * i), 0.5 + 0.5 * std::cos(i));
        points.push_back({middle - half_width, color, 0.0});
        points.push_back({middle, color, 0.6});
        points.push_back({middle + half_width, color, 0.0});
    }
    return points;
}

Session reference_session(const std::vector<ControlPoint>& points, const glm::uvec2& pixels = {24, 18})
{
    Session session = plain_session(points, pixels);
    session.render.opacity_limit = 1.0;
    session.render.exact_integral = true;
    session.render.step_voxels = 1.0;
    return session;
}

}  // namespace

TEST_CASE("quality reference meets the reference in the bench's scenes")
{
    golden::set_environment();
    const int64_t side = repeats<int64_t>(24, 32);
    for (const bench::Scene& scene : bench::own_scenes(side, repeats(glm::uvec2(24, 18), glm::uvec2(48, 36)))) {
        // Its light is no integral along the ray of a pixel: below.
        if (scene.name != "occluded") check_scene(in_quality_reference(scene));
    }
}

TEST_CASE("quality reference meets the reference where ambient light is occluded, except for the light at voxels")
{
    golden::set_environment();
    const int64_t side = repeats<int64_t>(24, 32);
    for (bench::Scene scene : bench::own_scenes(side, repeats(glm::uvec2(24, 18), glm::uvec2(48, 36)))) {
        if (scene.name != "occluded") continue;
        scene = in_quality_reference(scene);
        golden::Studio studio(scene.drawn, {.device = {}, .validation = true, .budget_device = scene.budget_device});
        const ImageF picture = studio.picture_of(studio.session(), studio.camera(), false).image;
        bench::ReferenceScene expected = scene_of(studio);
        const ImageF defined = truth_of(studio, expected);
        // The same, with the light that the device has at voxels, in 8 bits, instead of the definition's.
        const OcclusionSettings& settings = studio.session().light.occlusion;
        std::vector<double>& shares = expected.scene.shading->ambient_shares;
        const std::vector<double> values = occlusion_values(studio.renderer(), expected.scene.size);
        REQUIRE(shares.size() == values.size());
        double squares = 0.0;
        for (size_t i = 0; i < shares.size(); ++i) {
            const double share = 1.0 - settings.strength * (1.0 - seen_of(settings, std::clamp(values[i], 1e-4, 1.0)));
            squares += (share - shares[i]) * (share - shares[i]);
            shares[i] = share;
        }
        CHECK(squares > 0.0);
        check_below("RMSE with the device's light at voxels", bench::error_of(picture, truth_of(studio, expected)).rmse,
                    MAX_RMSE);
        check_below("RMSE with the definition's light at voxels", bench::error_of(picture, defined).rmse, 5e-3);
        CHECK(studio.take_validation_messages() == std::vector<std::string>{});
    }
}

// Kind (Light): transfer functions of many narrow peaks
TEST_CASE_FIXTURE(OnDevice, "quality reference resolves forty narrow peaks of the transfer function")
{
    load(noise_volume({20, 20, 20}, 3));
    const Camera camera = camera_along(volume(), {1, 0.3, 0.2}, 20.0);
    for (const bool is_shaded : {false, true}) {
        CAPTURE(is_shaded);
        Session session = reference_session(narrow_peaks(40));
        session.light.shaded = is_shaded;
        const Pixels truth = expected(session, camera, reference::ExactOptions{.tolerance = 1e-8});
        const Pixels whole = pixels_of(draw(session, camera));
        check_below("RMSE", rms_difference(whole, truth), MAX_RMSE);
        session.render.step_voxels = 0.5;
        check_below("change by half the step", rms_difference(pixels_of(draw(session, camera)), whole),
                    MAX_RMSE_OF_HALVING);
    }
}

// With the light at the eye it begins and ends where the density turns: a piece would be halved until nothing is left
// of it, and devices that end long loops would lose the rest.
// Kind (Light): light that ends at an extremum of the density along a ray
TEST_CASE_FIXTURE(OnDevice, "an exact integral advances where light ends within rounding of an extremum of density")
{
    load(volume_of({16, 16, 16},
                   [](const glm::dvec3& voxel) { return 32768.0 + 380.0 * (voxel.x - 7.3) * (voxel.y - 8.8); }));
    const Camera camera = camera_along(volume(), {1.0, -0.7, 0.3}, 14.0);
    Session session = reference_session(busy_points(0.1));
    session.light.shaded = true;
    session.light.direction = {0.0, 0.0, 1.0};
    const Pixels truth = expected(session, camera, reference::ExactOptions{.tolerance = 1e-8});
    check_below("RMSE", rms_difference(pixels_of(draw(session, camera)), truth), MAX_RMSE);
}

TEST_CASE("an exact integral has the same bits at every budget, with skipping and without")
{
    const Source source = tubes({150, 131, 170});
    const Camera camera = camera_looking("right", source->info());
    Budgeted unlimited;
    Budgeted tight(16);  // MiB: rays wait for bricks
    for (const bool is_shaded : {false, true}) {
        CAPTURE(is_shaded);
        Session session = session_of(is_shaded ? 0.02 : 1.0, is_shaded);
        session.render.size = {24, 18};
        session.render.step_voxels = 1.0;
        session.render.sampling = Sampling::exact;
        session.render.exact_integral = true;
        session.render.detail = 0.0;
        const Picture expected = unlimited.picture(source, session, Paging::never, camera);
        CHECK(expected.complete);
        const Picture waited = tight.picture(source, session, Paging::always, camera);
        CHECK(waited.complete);
        check_below("differing bits", double(different_bits(waited.image, expected.image)), 0.0);
        session.render.skip_empty_space = false;
        const Picture patient = unlimited.picture(source, session, Paging::never, camera);
        check_below("differing bits", double(different_bits(patient.image, expected.image)), 0.0);
    }
}
