// The interactive view: it must come to rest on the picture that `shvr render` makes, and do no more work than
// necessary.

#include <cstring>
#include <random>
#include <set>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "engine/live/view.h"
#include "engine/passes/encode.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Everything slow: coarse sketches, tiles one by one.
constexpr View::Options CRAWLING{.step_ms = 1e-6, .in_flight_ms = 1e-5, .motion_ms = 1e-5, .probe_ms = 1e-5};

using ScreenPixels = std::vector<uint32_t>;  // 4 bytes a pixel

class Seen : public OnDevice {
public:
    Session session = plain_session(busy_points(), {150, 90});
    std::optional<ProbeLook> probe;

    Seen() { load(noise_volume({40, 33, 50}, 71)); }
    glm::uvec2 pixels() const { return session.render.size; }

    static void settle(View& view)
    {
        for (int i = 0; !view.complete(); ++i) {
            nap(i);
            REQUIRE(i < 10'000'000);
            view.advance();
        }
    }
    static ScreenPixels shown(View& view)
    {
        const Image8 image = view.read_back();
        ScreenPixels screen(image.rgba.size() / 4);
        std::memcpy(screen.data(), image.rgba.data(), image.rgba.size());
        return screen;
    }
    /// The picture of Renderer::render, encoded.
    ScreenPixels direct(const Camera& camera)
    {
        const glm::uvec2 size = pixels();
        FrameGraph graph;
        const Resource light =
            shvr::draw(graph, renderer().scene(), session.look(), camera, {.pixels = size, .end = size, .probe = probe},
                       graph.create("light", picture_desc(Format::rgba32_float, size)))
                .target;
        gpu::EncodeParams params{};
        params.size = size;
        params.first = glm::vec2(0.5f);
        params.step = glm::vec2(1.0f);
        params.last = size - 1u;
        params.behind = glm::vec3(0.05f);
        graph.read_back(encode(graph, light, graph.create("display", picture_desc(Format::rgba8_unorm, size)), params));
        const std::vector<std::byte> bytes = renderer().executor().run(std::move(graph)).read_backs[0];
        ScreenPixels texels(bytes.size() / 4);
        std::memcpy(texels.data(), bytes.data(), bytes.size());
        return texels;
    }
    Camera camera(const glm::dvec3& direction) const { return camera_along(volume(), direction, 60.0); }
};

}  // namespace

TEST_CASE_FIXTURE(Seen, "a view comes to rest on the direct picture, bit for bit, fast device or slow")
{
    probe = ProbeLook{.center = {20, 16, 25}, .radius = 6.0, .color = {0.9, 0.1, 0.1}};
    View::Options swapped;
    swapped.swap_red_blue = true;
    for (const View::Options& options : {View::Options{}, CRAWLING, swapped}) {
        View view(renderer(), options);
        view.show_probe(probe);
        for (const glm::dvec3& direction : {glm::dvec3(1, 2, 3), glm::dvec3(-1, 0.2, 0)}) {
            view.look(session, camera(direction), pixels());
            settle(view);
            const ScreenPixels is = shown(view), expected = direct(camera(direction));
            size_t differing = is.size() == expected.size() ? 0 : 1;
            for (size_t i = 0; i < std::min(is.size(), expected.size()); ++i) differing += is[i] != expected[i];
            CAPTURE(direction.x);
            check_below("differing pixels", double(differing), 0.0);
        }
    }
}

TEST_CASE_FIXTURE(Seen, "surfaces are in the sketch, in the tiles and around the probe")
{
    probe = ProbeLook{.center = {20, 16, 25}, .radius = 6.0, .color = {0.9, 0.1, 0.1}};
    const std::vector<SurfaceLook> rods{{{5, 5, 5}, {30, 20, 40}, 3.0, 1.0, GREEN},
                                        {{20, 25, 5}, {20, 10, 60}, 2.0, 2.0}};
    for (const View::Options& options : {View::Options{}, CRAWLING}) {
        View view(renderer(), options);
        view.show_probe(probe);
        view.look(session, camera({1, 2, 3}), pixels());
        settle(view);
        const ScreenPixels without = shown(view);
        for (int steps = 0; steps < 7; ++steps) view.advance();
        renderer().scene().set_surfaces(rods);
        view.look(session, camera({1, 2, 3}), pixels());
        settle(view);
        CHECK((shown(view) != without));
        CHECK(shown(view) == direct(camera({1, 2, 3})));
        for (int steps = 0; steps < 5; ++steps) view.advance();  // in the middle of a picture
        view.look(session, camera({2, 2, 3}), pixels());
        for (int steps = 0; steps < 20; ++steps) view.advance();
        renderer().scene().set_surfaces({});
        view.look(session, camera({1, 2, 3}), pixels());
        settle(view);
        CHECK((shown(view) == without));
    }
}

TEST_CASE_FIXTURE(Seen, "a view with less colour comes to rest on the direct picture, a moving probe's pixels included")
{
    View view(renderer(), CRAWLING);
    for (const double saturation : {0.25, 1.0, 0.0}) {
        session.render.saturation = saturation;
        for (const double x : {12.0, 20.0}) {
            probe = ProbeLook{.center = {x, 16, 25}, .radius = 6.0, .color = {0.9, 0.1, 0.1}};
            view.look(session, camera({1, 2, 3}), pixels());
            view.show_probe(probe);
            settle(view);
            CHECK(shown(view) == direct(camera({1, 2, 3})));
        }
    }
}

namespace {

/// Pixels of sharp tiles that are shown.
uint64_t sharp_pixels(const View& view)
{
    uint64_t pixels = 0;
    for (const View::Layer& layer : view.layers())
        if (layer.image.desc.format == Format::rgba8_unorm && layer.source.begin == layer.target.begin)
            pixels += layer.source.area();
    return pixels;
}

}  // namespace

TEST_CASE_FIXTURE(Seen,
                  "sharp tiles are shown a good part of the picture at a time, and all at once if they take a moment")
{
    session.render.size = {320, 256};  // 80 tiles
    for (const double moment_ms : {0.0, 1e6}) {
        View::Options options = CRAWLING;
        options.moment_ms = moment_ms;
        View view(renderer(), options);
        view.look(session, camera({1, 2, 3}), pixels());
        std::set<size_t> seen;
        for (int i = 0; !view.complete(); ++i) {
            nap(i);
            REQUIRE(i < 10'000'000);
            view.advance();
            seen.insert(view.layers().size() > 1 ? sharp_pixels(view) - pixels().x * pixels().y : 0);
        }
        CAPTURE(moment_ms);
        // Nothing, then five parts of fourteen tiles, then all of it.
        CHECK(seen.size() == (moment_ms == 0.0 ? 6 : 1));
        CHECK(shown(view) == direct(camera({1, 2, 3})));
    }
}

TEST_CASE_FIXTURE(Seen, "nothing is submitted when nothing changed")
{
    View view(renderer());
    view.advance();
    CHECK(view.submissions() == 0);
    view.look(session, camera({1, 2, 3}), pixels());
    settle(view);
    const uint64_t submissions = view.submissions(), revision = view.revision();
    for (int i = 0; i < 100; ++i) view.advance();
    CHECK(view.submissions() == submissions);
    CHECK(view.revision() == revision);
}

TEST_CASE_FIXTURE(Seen, "a probe that moves draws the pixels it may cover, and the rest stays")
{
    View view(renderer(), CRAWLING);
    view.look(session, camera({1, 2, 3}), pixels());
    settle(view);
    const uint64_t for_all = view.submissions();
    std::mt19937 random(72);  // seed 72
    for (int trial = 0; trial < 12; ++trial) {
        const auto within = [&](double end) { return end * double(random()) / 4294967296.0; };
        probe = ProbeLook{.center = {within(40), within(33), within(50)}, .radius = 1.0 + within(4), .color = RED};
        const uint64_t before = view.submissions();
        view.show_probe(probe);
        settle(view);
        CHECK(view.submissions() - before < for_all / 2);
        CHECK(shown(view) == direct(camera({1, 2, 3})));
    }
    probe.reset();
    view.show_probe(probe);
    settle(view);
    CHECK(shown(view) == direct(camera({1, 2, 3})));
}

TEST_CASE_FIXTURE(Seen, "paint is seen where it is, whenever it comes")
{
    Annotator annotator(renderer());
    View view(renderer(), CRAWLING);
    view.look(session, camera({1, 2, 3}), pixels());
    std::mt19937 random(73);  // seed 73
    const auto below = [&](int end) { return int(random() % uint32_t(end)); };
    glm::dvec3 direction(1, 2, 3);
    for (int trial = 0; trial < 12; ++trial) {
        if (trial % 3 == 2) {
            direction.x += 1.0;
            view.look(session, camera(direction), pixels());
        }
        for (int steps = below(60); steps > 0; --steps) view.advance();  // in the middle of anything
        const glm::ivec3 at(below(40), below(33), below(50));
        annotator.paint(
            {.brush = Brush::fill, .group = uint8_t(1 + trial % 3), .radius_voxels = 4.0, .path = {glm::dvec3(at)}});
        view.changed({Size3(glm::max(at - 5, 0)), Size3(glm::min(at + 6, glm::ivec3(40, 33, 50)))});
        if (trial % 2 == 0) continue;
        settle(view);
        CHECK(shown(view) == direct(camera(direction)));
    }
}

TEST_CASE_FIXTURE(Seen, "a camera that never rests is followed, and the last picture is the one that counts")
{
    View view(renderer());
    uint64_t seen = 0;
    for (int i = 0; i < 60; ++i) {
        view.look(session, camera({1, 2, 3.0 + 0.1 * i}), pixels());
        const uint64_t revision = view.revision();
        for (int steps = 0; steps < 10'000'000 && view.revision() == revision; ++steps) view.advance();
        seen += view.revision() != revision;
    }
    CHECK(seen == 60);  // each picture begins before the previous one is sharp
    settle(view);
    CHECK(shown(view) == direct(camera({1, 2, 3.0 + 5.9})));
}
