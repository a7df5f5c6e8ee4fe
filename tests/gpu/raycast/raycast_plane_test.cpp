// The cutting plane of any orientation, against the reference in double.

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

TestVolume slopes()
{
    TestVolume volume =
        volume_of({30, 26, 34}, [](const glm::dvec3& p) { return 9000.0 + 1500.0 * p.x + 300.0 * p.y + 100.0 * p.z; });
    volume.spacing = {1.0, 1.25, 0.8};
    return volume;
}

Session translucent()
{
    return plain_session(
        {{9000.0, {0.9, 0.2, 0.1}, 0.02}, {30000.0, {0.2, 0.8, 0.1}, 0.1}, {60000.0, {0.1, 0.2, 0.9}, 0.05}}, {20, 20});
}

const glm::dvec3 NORMALS[] = {{1.0, 0.0, 0.0}, {0.0, -2.0, 0.0}, {0.3, 1.0, -0.7}, {-5.0, -2.0, 1.0}};

}  // namespace

TEST_CASE_FIXTURE(OnDevice,
                  "what a plane of any orientation leaves is the reference's picture, with the box and without")
{
    load(slopes());
    for (const bool is_integrated : {false, true})
        for (const glm::dvec3& normal : NORMALS) {
            CAPTURE(is_integrated);
            CAPTURE(normal.x);
            Session session = translucent();
            session.render.exact_integral = is_integrated;
            session.render.sampling = Sampling::exact;
            if (is_integrated) session.render.step_voxels = session.render.opacity_limit = 1.0;
            session.cut.plane_normal = normal;
            const auto check = [&](const char* what) {
                for (const Camera& camera :
                     {camera_along(volume(), {0, 0, 1}, 40.0), camera_along(volume(), {-0.5, 1, 0.7}, 40.0),
                      perspective({15.0, 13.0, 16.0}, {0.0, 1.0, 3.0}, 90.0)}) {
                    const Pixels truth = is_integrated
                                             ? expected(session, camera, reference::ExactOptions{.tolerance = 1e-8})
                                             : discrete(session, camera);
                    check_below(what, worst_difference(pixels_of(draw(session, camera)), truth), 1e-5);
                }
            };
            check("through the middle");
            session.cut.plane_point = glm::dvec3(9.3, 20.1, 11.7);
            check("elsewhere");
            session.cut.lower = {3.0, 4.5, 2.0};
            session.cut.upper = {20.25, 20.0, 30.0};
            check("with the box");
        }
}

TEST_CASE_FIXTURE(OnDevice, "a plane beyond the volume cuts nothing or all, and one along the rays what is beyond it")
{
    load(slopes());
    const Camera camera = camera_along(volume(), {0, 0, 1}, 42.0);  // no pixel's middle is on a face
    Session session = translucent();
    const ImageF whole = draw(session, camera);
    session.cut.plane_normal = glm::dvec3(1.0, 0.0, 0.0);
    session.cut.plane_point = glm::dvec3(30.5, 0.0, 0.0);
    check_below("differing bits", double(different_bits(whole, draw(session, camera))), 0.0);
    session.cut.plane_point = glm::dvec3(-0.5, 0.0, 0.0);
    const ImageF none = draw(session, camera);
    session.cut = {};
    session.view.volume = false;
    check_below("differing bits", double(different_bits(none, draw(session, camera))), 0.0);
    // Half of the picture, whose rays are parallel to the plane, is as it was.
    session.view.volume = true;
    session.cut.plane_normal = glm::dvec3(1.0, 0.0, 0.0);
    const Pixels half = pixels_of(draw(session, camera)), all = pixels_of(whole), nothing = pixels_of(none);
    size_t as_before = 0, away = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        CHECK((half[i] == all[i] || half[i] == nothing[i]));
        as_before += half[i] == all[i] && all[i] != nothing[i];
        away += half[i] == nothing[i] && all[i] != nothing[i];
    }
    CHECK(as_before == away);
    CHECK(away > 50);
}

TEST_CASE_FIXTURE(OnDevice, "a click meets what the plane leaves")
{
    load(volume_of({32, 32, 32}, [](const glm::dvec3&) { return 40000.0; }));
    Session session = plain_session({{0.0, glm::dvec3(1.0), 0.5}, {65535.0, glm::dvec3(1.0), 0.5}}, {16, 16});
    const Camera camera = camera_along(volume(), {0, 0, 1}, 40.0);
    const auto hit = [&] { return renderer().pick(session.look(), camera, {16, 16}, {8, 8}, {}); };
    const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
    const auto before = hit();
    REQUIRE(before.has_value());
    session.cut.plane_normal = -forward;  // removes what lies before the middle
    const auto after = hit();
    REQUIRE(after.has_value());
    CHECK(glm::dot(after->point - before->point, forward) == doctest::Approx(16.0).epsilon(0.05));
}
