// Pictures made part by part, with every feature: the same bits as pictures drawn whole.

#include "engine/picture/picture_job.h"

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("a picture in parts has the bits of one drawn whole, resident and with paged bricks")
{
    const std::shared_ptr<const VolumeSource> tubes =
        open_procedural({.kind = "tubes", .size = {128, 128, 128}, .seed = 3});
    Session session;
    session.transfer_function =
        TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}});
    session.render.size = {101, 77};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    session.light.occlusion = {.strength = 0.8, .radius = 6.0, .rays = 8};
    session.blend = {.size = 0.5};
    const ProbeLook probe{.center = {60.0, 66.0, 70.0},
                          .radius = 25.0,
                          .color = {1.0, 0.5, 0.1},
                          .ball_share = 0.3,
                          .shell = ShellLook{.threshold = 100.0}};
    Renderer renderer({.device = {.validation = true}, .threads = 2});
    const Camera camera = camera_looking("front", tubes->info());
    for (const Paging paging : {Paging::never, Paging::always}) {
        session.render.paging = paging;
        renderer.load(tubes, {.minimum = 0.0, .maximum = 255.0}, session.render);
        for (const Arrangement arrangement : {Arrangement::single, Arrangement::slices, Arrangement::stereo}) {
            session.view.arrangement = arrangement;
            session.view.stereo.output = StereoOutput::anaglyph;
            RenderOptions options{.probe = probe, .outlines_probe = true};
            const Picture whole = renderer.render(session, camera, options);
            CHECK(whole.complete);
            for (const uint32_t side : {16u, 33u, 64u}) {
                options.part_pixels = side;
                ImageF image{101, 0, {}};
                PictureJob job(renderer, session, camera, options, [&](const ImageF& rows) {
                    CHECK(rows.width == image.width);
                    image.height += rows.height;
                    image.rgba.insert(image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
                });
                int steps = 0;
                double before = 0.0;
                for (; !job.is_done(); ++steps) {
                    job.step();
                    CHECK(job.progress() >= before);
                    before = job.progress();
                }
                CHECK(before == 1.0);
                CHECK(steps >= int(101 / side * (77 / side)));
                CHECK(job.take().complete);
                CHECK(different_bits(image, whole.image) == 0);
            }
        }
    }
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("a picture that memory does not hold is refused before any is taken")
{
    Renderer renderer({.device = {.validation = true}, .budget = {0, 64 << 20}, .threads = 1});
    renderer.load(open_procedural({.kind = "sphere", .size = {16, 16, 16}}), {.minimum = 0.0, .maximum = 255.0});
    Session session;
    session.render.size = {4096, 4096};
    CHECK_THROWS_WITH(renderer.render(session, camera_looking("front", renderer.volume().info())),
                      "render.size is 4096 x 4096 pixels, which take 256 MiB of memory; expected at most the host's "
                      "budget, 64 MiB");
}
