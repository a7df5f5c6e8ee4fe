// What the window needs of the ray caster besides whole pictures: parts, the probe's ball, and the position at a pixel.

#include <cmath>
#include <cstring>

#include <doctest/doctest.h>

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
    for (const auto& [begin, end] : parts) {
        FrameGraph graph;
        const glm::uvec2 extent = end - begin;
        const Resource target = graph.create("part", image_desc(Format::rgba32_float, glm::uvec3(extent, 1)));
        graph.read_back(shvr::draw(graph, renderer().scene(), session.look(), camera,
                                   {.pixels = size, .begin = begin, .end = end, .probe = probe}, target)
                            .target);
        const gpu::FrameResult result = renderer().executor().run(std::move(graph));
        size_t different = 0;
        for (uint32_t y = 0; y < extent.y; ++y)
            different +=
                std::memcmp(result.read_backs[0].data() + size_t(y) * extent.x * 16,
                            whole.rgba.data() + 4 * (size_t(begin.y + y) * size.x + begin.x), extent.x * 16) != 0;
        CHECK(different == 0);
    }
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

TEST_CASE_FIXTURE(OnDevice, "a pixel is picked where its ray becomes half opaque")
{
    const TestVolume ramp =
        volume_of({40, 40, 40}, [](const glm::dvec3& voxel) { return voxel.y < 20.0 ? 1000.0 : 50000.0; });
    load(ramp);
    const Session session = plain_session({{20000.0, RED, 1.0}, {65535.0, RED, 1.0}}, {65, 65});
    const Camera camera = camera_looking("front", volume().info());
    const std::optional<glm::dvec3> hit = renderer().pick(session.look(), camera, {65, 65}, {32, 32});
    REQUIRE(hit.has_value());
    CHECK(glm::distance(*hit, glm::dvec3(20.0, 19.9, 20.0)) < 0.6);  // the step is half a voxel
    CHECK(!renderer().pick(session.look(), camera, {65, 65}, {0, 0}).has_value());
}
