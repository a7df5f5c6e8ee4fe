// Distance colour blending: a colour is mixed in with growing distance.

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

TestVolume slopes()
{
    return volume_of({30, 26, 34}, [](const glm::dvec3& p) { return 9000.0 + 1500.0 * p.x + 300.0 * p.y; });
}

Session blending_session(double size, double rate)
{
    Session session = plain_session(
        {{9000.0, {0.9, 0.2, 0.1}, 0.02}, {30000.0, {0.2, 0.8, 0.1}, 0.1}, {60000.0, {0.1, 0.2, 0.9}, 0.05}}, {20, 20});
    session.blend = {.size = size, .rate = rate, .color = glm::dvec3(0.1, 0.3, 0.8)};
    return session;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "blended pictures are those of the reference")
{
    load(slopes());
    for (const double size : {0.3, 1.0, 2.0})
        for (const double rate : {0.0, 0.5, 1.0, 2.0, 5.0}) {
            CAPTURE(size);
            CAPTURE(rate);
            Session session = blending_session(size, rate);
            check_below("along z", error(session, camera_along(volume(), {0, 0, 1}, 40.0)), 5e-6);
            check_below("askew", error(session, camera_along(volume(), {-0.5, 1, 0.7}, 40.0)), 5e-6);
            // Depth begins at the eye here.
            check_below("inside", error(session, perspective({15.0, 13.0, 16.0}, {0.0, 1.0, 3.0}, 90.0)), 5e-6);
            session.cut = {{3.0, 4.5, 2.0}, {20.25, 20.0, 30.0}};
            check_below("cut", error(session, camera_along(volume(), {1, 2, 3}, 40.0)), 5e-6);
            session.cut.plane_normal = glm::dvec3(0.3, 1.0, -0.7);
            check_below("cut obliquely", error(session, camera_along(volume(), {1, 2, 3}, 40.0)), 5e-6);
            session.cut.plane_normal = glm::dvec3(-1.0, -2.0, -2.5);  // the front is cut away
            check_below("cut from the front", error(session, camera_along(volume(), {1, 2, 3}, 40.0)), 5e-6);
            session.blend.color.reset();  // default: the background's
            check_below("to the background", error(session, camera_along(volume(), {1, 2, 3}, 40.0)), 5e-6);
        }
}

TEST_CASE_FIXTURE(OnDevice, "blending of size 0 changes no bit, and none leaves the background's")
{
    load(slopes());
    const Camera camera = camera_along(volume(), {1, 2, 3}, 60.0);
    Session plain = blending_session(0.0, 1.0);
    plain.blend = {};
    const ImageF unblended = draw(plain, camera);
    const Pixels expected = pixels_of(unblended);
    for (const double rate : {0.0, 1.0, 7.0}) {
        CAPTURE(rate);
        const ImageF image = draw(blending_session(0.0, rate), camera);
        check_below("differing bits", double(different_bits(image, unblended)), 0.0);
    }
    const Pixels blended = pixels_of(draw(blending_session(1.0, 1.0), camera));
    size_t background = 0, changed = 0;
    for (size_t i = 0; i < expected.size(); ++i) {
        background += expected[i] == expected[0];
        changed += blended[i] != expected[i];
        if (expected[i] == expected[0]) CHECK(blended[i] == expected[i]);
        CHECK(blended[i].w == expected[i].w);  // opacity is unchanged
    }
    CHECK(background > 20);
    CHECK(changed > 100);
}

TEST_CASE_FIXTURE(OnDevice, "an opaque surface takes the colour in the share that its depth and the formula say")
{
    load(volume_of({16, 16, 64}, [](const glm::dvec3&) { return 40000.0; }));
    for (const double z : {0.0, 16.0, 32.0, 60.0}) {
        Session session = plain_session({{0.0, {1.0, 0.0, 0.0}, 1.0}, {65535.0, {1.0, 0.0, 0.0}, 1.0}}, {1, 1});
        session.cut = {{0.0, 0.0, 0.0}, {16.0, 16.0, 64.0}};
        session.blend = {.size = 0.8, .rate = 2.0, .color = glm::dvec3(0.0, 0.0, 1.0)};
        // Seen along z, near clip plane at z: depth runs from there to the end, and the first sample is half a step in.
        Camera camera = camera_along(volume(), {0, 0, 1}, 8.0);
        camera.near_distance = glm::dot(glm::dvec3(0.0, 0.0, z) - camera.eye, glm::dvec3(0.0, 0.0, 1.0));
        const double depth = 0.5 * session.render.step_voxels / (64.0 - z);
        const double share = 0.8 * depth * depth;
        const glm::vec4 pixel = pixels_of(draw(session, camera))[0];
        CAPTURE(z);
        check_below("share", std::max(std::abs(pixel.x - (1.0 - share)), std::abs(pixel.z - share)), 1e-6);
        // The same share everywhere, also at depth 0.
        session.blend.rate = 0.0;
        check_below("share, rate 0", std::abs(pixels_of(draw(session, camera))[0].z - 0.8), 1e-6);
        session.blend.size = 2.0;  // clamped at 1
        check_below("share, size above 1", std::abs(pixels_of(draw(session, camera))[0].z - 1.0), 0.0);
        // A high rate changes nothing that is not at the far end.
        session.blend = {.size = 1.0, .rate = 1000.0, .color = glm::dvec3(0.0, 0.0, 1.0)};
        check_below("share, rate 1000", std::abs(pixels_of(draw(session, camera))[0].z), 0.0);
    }
}
