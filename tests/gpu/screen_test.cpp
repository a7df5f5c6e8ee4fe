// The panes of a screen: they come to rest on the picture that `shvr render` makes, share the device, and do no more
// work than necessary.

#include "engine/live/screen.h"

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"

using namespace shvr;
using namespace shvr::test;

namespace {

void settle(Screen& screen)
{
    for (int i = 0; !screen.complete(); ++i) {
        nap(i);
        REQUIRE(i < 10'000'000);
        screen.advance();
    }
}

constexpr Arrangement ALL[] = {Arrangement::single, Arrangement::stereo, Arrangement::overview, Arrangement::slices};

class Seen : public OnDevice {
public:
    Session session = plain_session(busy_points(), {150, 90});
    ProbeLook probe{.center = {12.5, 20.5, 30.5}, .radius = 0.001};  // too small for a pixel
    Camera camera = camera_along(volume(), {1, 2, 3}, 60.0);

    Seen()
    {
        load(noise_volume({40, 33, 50}, 71));
        session.probe.voxel = probe.center;
        session.light.shaded = true;
    }
    /// The difference between the shown and the rendered picture, in levels of 255.
    double off(Screen& screen)
    {
        settle(screen);
        const Image8 rendered = to_image8(renderer().render(session, camera).image);
        return compare_pixels(screen.read_back(), rendered).max_abs;
    }
};

}  // namespace

TEST_CASE_FIXTURE(Seen, "every arrangement ends as the picture of render, wherever it comes from")
{
    View::Options slow;
    slow.step_ms = slow.motion_ms = 0.05;
    Screen screen(renderer(), slow);
    for (const Arrangement from : ALL)
        for (const Arrangement to : ALL)
            for (const Arrangement arrangement : {from, to}) {
                session.view.arrangement = arrangement;
                screen.look(session, camera, session.render.size, probe.center);
                screen.show_probe(probe);
                for (int steps = 0; steps < 3; ++steps) screen.advance();  // interrupted
                if (arrangement == to) CHECK(off(screen) <= 1.0);
            }
}

TEST_CASE_FIXTURE(Seen, "panes that stay as they are, are not drawn again")
{
    Screen screen(renderer(), {});
    session.view.arrangement = Arrangement::overview;
    screen.look(session, camera, session.render.size, probe.center);
    screen.show_probe(probe);
    settle(screen);
    const auto counts = [&] {
        std::vector<uint64_t> submissions;
        for (const Screen::Part& part : screen.parts()) submissions.push_back(part.view->submissions());
        return submissions;
    };
    std::vector<uint64_t> before = counts();
    for (int i = 0; i < 100; ++i) screen.advance();
    CHECK((counts() == before));  // nothing changed
    camera = camera_along(volume(), {3, 2, 1}, 60.0);
    screen.look_from(camera, probe.center);
    settle(screen);
    std::vector<uint64_t> after = counts();
    CHECK(after[0] > before[0]);
    for (size_t map = 1; map < 4; ++map) CHECK(after[map] == before[map]);
    CHECK(off(screen) <= 1.0);

    session.view.arrangement = Arrangement::slices;
    screen.look(session, camera, session.render.size, probe.center);
    settle(screen);
    before = counts();
    probe.center.z += 3.0;  // across the first slice, within the planes of the others
    session.probe.voxel = probe.center;
    screen.show_probe(probe);
    settle(screen);
    after = counts();
    CHECK(after[1] > before[1]);
    CHECK(after[2] == before[2]);
    CHECK(after[3] == before[3]);
    CHECK(off(screen) <= 1.0);
}

TEST_CASE("panes of paged bricks end as the picture of render, under a budget for one of them")
{
    const std::shared_ptr<const VolumeSource> tubes =
        open_procedural({.kind = "tubes", .size = {256, 256, 256}, .seed = 3});
    Session session;
    session.transfer_function =
        TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}});
    session.render.size = {128, 96};
    session.render.sampling = Sampling::exact;
    session.render.paging = Paging::always;
    session.render.detail = 0.0;
    Renderer renderer({.device = {.validation = true}, .budget = {256 << 20, 0}, .threads = 2});
    renderer.load(tubes, {.minimum = 0.0, .maximum = 255.0}, session.render);
    const Camera camera = camera_looking("front", tubes->info());
    const glm::dvec3 probe(100.5, 128.5, 90.5);
    session.probe.voxel = probe;
    for (const Arrangement arrangement : {Arrangement::slices, Arrangement::overview}) {
        session.view.arrangement = arrangement;
        Screen screen(renderer, {});
        screen.look(session, camera, session.render.size, probe);
        screen.show_probe({.center = probe, .radius = 0.001});
        settle(screen);
        const Image8 shown = screen.read_back();
        const Picture picture = renderer.render(session, camera);
        if (picture.complete) CHECK(compare_pixels(shown, to_image8(picture.image)).max_abs <= 1.0);
    }
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
}
