// Iso-surfaces far along a ray, where a thousandth of a reference length is less than an ulp.

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE_FIXTURE(OnDevice, "an iso-surface 100 000 reference lengths along the ray is found")
{
    // One step in intensity, between the third and the fourth of four slices.
    for (const double slice : {1.0, 3.0}) {
        CAPTURE(slice);
        TestVolume made = volume_of({4, 4, 4}, [&](const glm::dvec3& at) { return at.z > slice ? 60000.0 : 1000.0; });
        made.spacing = {1.0, 1.0, 30000.0};
        load(std::move(made));
        Session session = plain_session(unseen_points(), {4, 4});
        session.render.step_voxels = 4.0;
        const Camera camera = camera_along(volume(), {0, 0, 1}, 4.0);
        ProbeLook probe{.center = {2.0, 2.0, 60000.0}, .radius = 1e6, .ball_share = 0.0};
        probe.shell = ShellLook{.threshold = 30000.0, .opacity = 0.5};
        const Picture picture = renderer().render(session, camera, {.probe = probe});
        CHECK(picture.warnings.empty());
        const Picture without = renderer().render(session, camera);
        CHECK(different_bits(picture.image, without.image) > 16);
    }
}
