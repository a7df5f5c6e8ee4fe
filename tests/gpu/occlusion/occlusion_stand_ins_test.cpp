// Ambient light in a view whose budget has no room for all the bricks that it comes from: coarser ones stand in for
// them. Pictures say so and are drawn without light (tests/gpu/budget_test.cpp); a view shows what it can.

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/view.h"
#include "engine/volume/procedural/source_procedural.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"

using namespace shvr;
using namespace shvr::test;

namespace {

struct Shown {
    Image8 image;
    /// Bricks that are drawn and whose light has, or has not, all that it comes from.
    size_t with_all = 0, without_all = 0;
};

Shown view_at_rest(const std::shared_ptr<const VolumeSource>& source, const Session& session, const Camera& camera,
                   uint64_t device_mib)
{
    Renderer renderer({.device = {.validation = true}, .budget = {device_mib << 20, 0}, .threads = 2});
    renderer.load(source, measure(*source), session.render, shows_occlusion(session.light));
    View view(renderer);
    view.look(session, camera, session.render.size);
    for (int i = 0; !view.complete(); ++i) {
        nap(i);
        REQUIRE(i < 100'000'000);
        view.advance();
    }
    Shown shown{.image = view.read_back()};
    for (const DeviceVolume::Place& place : renderer.volume().places()) {
        if (!renderer.volume().is_drawn(place.key)) continue;
        ++(renderer.scene().occlusion().is_lit(place.key) ? shown.with_all : shown.without_all);
    }
    CHECK(renderer.memory().peak_device_bytes() <= device_mib << 20);
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    return shown;
}

}  // namespace

TEST_CASE("coarser bricks stand in for those that light comes from and that there is no room for")
{
    // Light comes to each brick from all 125. The eye sees so few that they are there in every budget.
    const std::shared_ptr<const VolumeSource> source =
        open_procedural({.kind = "fog", .size = {160, 160, 160}, .seed = 5});
    Camera camera = camera_looking("front", source->info());
    camera.projection = Camera::Projection::orthographic;
    camera.height = 30.0;
    Session session;
    session.render.size = {64, 64};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    session.light.occlusion = {.strength = 1.0, .radius = 40.0, .rays = 8};
    struct Case {
        const char* name;
        TransferFunction function;
        double bound;  ///< rms of 255 levels
    };
    // Bounds are below what comes of ramps, or of the coarser cells, that are left out or not fitted to their taps.
    const Case cases[] = {
        {"dense fog, light through coarser bricks",
         TransferFunction({{90.0, {0.8, 0.3, 0.1}, 0.0}, {140.0, {0.9, 0.7, 0.3}, 0.3}, {255.0, WHITE, 0.6}}), 0.12},
        {"thin fog, light through coarser bricks", TransferFunction({{30.0, WHITE, 0.0}, {255.0, WHITE, 0.06}}), 0.17},
    };
    for (const Case& each : cases) {
        CAPTURE(std::string(each.name));
        session.transfer_function = each.function;
        session.light.occlusion.strength = 1.0;
        const Shown expected = view_at_rest(source, session, camera, 512);
        const Shown seen = view_at_rest(source, session, camera, 16);
        CHECK(expected.with_all > 0);
        CHECK(expected.without_all == 0);
        CHECK(seen.with_all == 0);
        CHECK(seen.without_all > 0);
        const PixelDifference difference = compare_pixels(seen.image, expected.image);
        CHECK(difference.max_abs <= 1.0);
        check_below(each.name, difference.rmse, each.bound);
        session.light.occlusion.strength = 0.0;
        CHECK(compare_pixels(view_at_rest(source, session, camera, 512).image, expected.image).rmse > 11.5);
    }
}
