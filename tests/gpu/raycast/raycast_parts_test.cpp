// Ray casting for the window, in addition to whole pictures: parts, the probe's ball, and the position at a pixel.

#include <cmath>
#include <cstring>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/gpu/parts.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE_FIXTURE(OnDevice, "a picture drawn in parts has the bits of one drawn whole")
{
    load(noise_volume({40, 33, 50}, 18));
    Session session = plain_session(busy_points(), {61, 47});
    session.light.shaded = true;
    const Camera camera = camera_along(volume(), {3, 2, 1}, 60.0);
    const ProbeLook probe{.center = {20, 16, 25}, .radius = 6.0, .color = {0.9, 0.1, 0.1}};
    const glm::uvec2 size = session.render.size, cut(23, 17);
    const ImageF whole = renderer().render(session, camera, {.probe = probe}).image;
    CHECK(different_bits(whole, draw(session, camera)) > 100);  // the probe is visible

    const std::pair<glm::uvec2, glm::uvec2> parts[] = {
        {{0, 0}, cut}, {{cut.x, 0}, {size.x, cut.y}}, {{0, cut.y}, {cut.x, size.y}}, {cut, size}};
    for (const auto& [begin, end] : parts)
        check_below("differing rows", double(differing_rows(renderer(), session, camera, whole, begin, end, probe)),
                    0.0);
}

TEST_CASE_FIXTURE(OnDevice, "the probe hides what is behind it, and nothing else")
{
    const TestVolume empty = constant_volume({40, 40, 40}, 1000.0);
    load(empty);
    Session session = plain_session({{20000.0, RED, 0.1}, {65535.0, RED, 0.2}}, {65, 65});
    session.light = {.shaded = false, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    const ProbeLook probe{.center = {20, 20, 20}, .radius = 10.0, .color = {0.2, 0.4, 0.6}};
    // A pixel is one voxel wide: the ball covers those whose centre is within its radius, also the half in front of the
    // volume.
    for (const glm::dvec3& direction : cube_directions()) {
        const Camera camera = camera_along(volume(), direction, 65.0);
        const ImageF image = renderer().render(session, camera, {.probe = probe}).image;
        size_t wrong = 0;
        for (int y = 0; y < 65; ++y)
            for (int x = 0; x < 65; ++x) {
                const double distance = std::hypot(x - 32, y - 32);
                const float red = image.rgba[4 * size_t(x + 65 * y)];
                const bool is_probe = std::abs(red - 0.2f) < 1e-6f, is_background = red == 0.0f;
                wrong += distance < 9.99 ? !is_probe : distance > 10.01 ? !is_background : false;
            }
        CHECK(wrong == 0);
    }
}

TEST_CASE_FIXTURE(OnDevice, "what is seen at a pixel is where its ray's opacity rises most")
{
    const TestVolume ramp =
        volume_of({40, 40, 40}, [](const glm::dvec3& voxel) { return voxel.y < 20.0 ? 1000.0 : 50000.0; });
    load(ramp);
    const Session session = plain_session({{20000.0, RED, 1.0}, {65535.0, RED, 1.0}}, {65, 65});
    const Camera camera = camera_looking("front", volume().info());
    const auto seen = renderer().pick(session.look(), camera, {65, 65}, {32, 32});
    REQUIRE(seen.has_value());
    CHECK(glm::distance(seen->point, glm::dvec3(20.0, 19.9, 20.0)) < 0.6);  // the step is half a voxel
    CHECK(!renderer().pick(session.look(), camera, {65, 65}, {0, 0}).has_value());
}

namespace {

/// Along y: haze, a thin bright sheet at 6, and a translucent block from 14 to 34, dimmer than the sheet.
TestVolume sheet_before_block()
{
    return volume_of({40, 40, 40}, [](const glm::dvec3& voxel) {
        const double y = std::floor(voxel.y);
        return y == 6.0 ? 30000.0 : y >= 14.0 && y < 34.0 ? 20000.0 : 5000.0;
    });
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "the probe lands on what adds most to a ray, in translucent volumes too")
{
    load(sheet_before_block());
    const Camera camera = camera_along(volume(), {0, 1, 0}, 8.0);
    // Haze adds nothing that is seen; the sheet at most 0.12; the block of 20 voxels 0.87, and half of that never.
    const auto ends = [&](double haze, double sheet, double block) {
        return plain_session({{4000.0, RED, haze},
                              {6000.0, RED, haze},
                              {19000.0, RED, block},
                              {21000.0, RED, block},
                              {29000.0, RED, sheet},
                              {65535.0, RED, sheet}},
                             {1, 1});
    };
    const auto seen = [&](const Session& session, const Camera& from) {
        return renderer().pick(session.look(), from, {1, 1}, {0, 0});
    };
    Session session = ends(0.0, 0.12, 0.1);
    REQUIRE(seen(session, camera).has_value());
    CHECK(std::abs(seen(session, camera)->point.y - 14.0) < 1.0);  // the block, though the sheet is steeper
    CHECK(seen(session, camera)->opacity > 0.85);
    session = ends(0.0, 0.7, 0.02);  // the sheet, though the block is longer
    CHECK(std::abs(seen(session, camera)->point.y - 6.5) < 1.0);
    session = ends(0.0, 0.0, 0.0);
    CHECK(!seen(session, camera).has_value());
    session = ends(0.0002, 0.0, 0.0);  // 0.8 % in all
    CHECK(!seen(session, camera).has_value());

    // It agrees with the drawn picture: cuts, clip planes, offsets of depth from the camera.
    session = ends(0.0, 0.12, 0.1);
    session.cut.lower.y = 20.0;
    CHECK(std::abs(seen(session, camera)->point.y - 20.0) < 0.6);
    session.cut = {};
    session.cut.upper.y = 13.0;
    CHECK(std::abs(seen(session, camera)->point.y - 6.5) < 1.0);
    session.cut = {};
    Camera clipped = camera;
    clipped.near_distance = 25.0 - camera.eye.y;  // along y, from the eye
    CHECK(std::abs(seen(session, clipped)->point.y - 25.0) < 0.6);
    clipped = camera;
    clipped.far_distance = 10.0 - camera.eye.y;
    CHECK(std::abs(seen(session, clipped)->point.y - 6.5) < 1.0);
}

TEST_CASE_FIXTURE(OnDevice, "the probe lands on painted groups where they are shown, and on none that is hidden")
{
    load(sheet_before_block());
    const Camera camera = camera_along(volume(), {0, 1, 0}, 8.0);
    Session session = plain_session({{40000.0, RED, 0.0}, {65535.0, RED, 0.0}}, {1, 1});
    Annotator annotator(renderer());
    static_cast<void>(annotator.paint({.brush = Brush::fill,
                                       .region = RegionShape::box,
                                       .group = 2,
                                       .threshold = 0.0,
                                       .radius_voxels = 3.0,
                                       .path = {{20.0, 24.0, 20.0}}}));
    renderer().scene().advance();
    session.groups[2] = {.name = "two", .color = GREEN, .opacity = 0.3};
    const auto seen = renderer().pick(session.look(), camera, {1, 1}, {0, 0});
    REQUIRE(seen.has_value());
    CHECK(std::abs(seen->point.y - 21.0) < 0.8);
    session.groups[2].visible = false;
    CHECK(!renderer().pick(session.look(), camera, {1, 1}, {0, 0}).has_value());
}
