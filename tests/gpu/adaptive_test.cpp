// Pictures whose rays are closer where there is more to see (shaders/adaptive.h), against pictures with a ray for each
// pixel.

#include <algorithm>
#include <cmath>
#include <cstring>

#include <doctest/doctest.h>

#include "tests/gpu/parts.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

TestVolume waves(const glm::ivec3& size)
{
    return volume_of(size, [](const glm::dvec3& p) {
        return 32000.0 + 16000.0 * std::sin(p.x / 4.0) * std::cos(p.y / 5.0) + 12000.0 * std::sin(p.z / 6.0);
    });
}

class Adaptive : public OnDevice {
public:
    static constexpr double TINY = 1e-6;  ///< a tolerance that nothing but level colour is within
    Session session = plain_session(busy_points(), {151, 91});
    Camera camera;
    Adaptive() { show(waves({40, 33, 50})); }
    void show(TestVolume volume)
    {
        load(std::move(volume));
        camera = camera_along(this->volume(), {1, 2, 3}, 70.0);
    }
    Picture picture(double tolerance, const RenderOptions& options = {})
    {
        // Pictures reuse memory: without other pictures in between, pixels that are not drawn would look right.
        session.render.adaptive_tolerance = 0.0;
        for (int i = 0; i < 3 && tolerance > 0.0; ++i)
            renderer().render(session, camera_along(volume(), {-3, 1, -2}, 30.0), options);
        session.render.adaptive_tolerance = tolerance;
        return renderer().render(session, camera, options);
    }
    /// Counts the values of a picture with `tolerance` TINY that are off by more than rounding.
    size_t different(const RenderOptions& options = {})
    {
        const ImageF every = picture(0.0, options).image, some = picture(TINY, options).image;
        size_t found = 0;
        for (size_t i = 0; i < every.rgba.size(); ++i) found += std::abs(every.rgba[i] - some.rgba[i]) > 1e-5f;
        return found;
    }
    uint32_t width() const { return session.render.size.x; }
    uint32_t height() const { return session.render.size.y; }
};

glm::dvec4 at(const ImageF& image, uint32_t x, uint32_t y)
{
    const float* const light = &image.rgba[4 * (size_t(y) * image.width + x)];
    return {light[0], light[1], light[2], light[3]};
}

/// The middle of the pixels with rays that are nearest, as far as they lie in the picture.
glm::dvec4 between(const ImageF& every, uint32_t x, uint32_t y)
{
    const uint32_t left = x / 2 * 2, right = (x + 1) / 2 * 2, above = y / 2 * 2, below = (y + 1) / 2 * 2;
    return 0.25 * (at(every, left, above) + at(every, right, above) + at(every, left, below) + at(every, right, below));
}

const gpu::PassReport& pass_of(const Picture& picture, const std::string& name)
{
    const auto found = std::ranges::find(picture.passes, name, &gpu::PassReport::name);
    REQUIRE(found != picture.passes.end());
    return *found;
}

}  // namespace

TEST_CASE_FIXTURE(Adaptive, "blocks whose pixels differ have a ray for each, all others lie between every second one")
{
    const ImageF every = picture(0.0).image;
    for (const double tolerance : {0.03, 0.1}) {
        const ImageF some = picture(tolerance).image;
        int drawn = 0, interpolated = 0, wrong = 0;
        for (uint32_t y = 0; y + 2 < height(); y += 2)
            for (uint32_t x = 0; x + 4 < width(); x += 4) {
                glm::dvec4 least(1.0), most(0.0);
                for (const uint32_t dy : {0u, 2u})
                    for (const uint32_t dx : {0u, 2u, 4u}) {
                        const glm::dvec4 seen = glm::sqrt(glm::clamp(at(every, x + dx, y + dy), 0.0, 1.0));
                        least = glm::min(least, seen);
                        most = glm::max(most, seen);
                    }
                const glm::dvec4 apart = most - least;
                const double range = std::max({apart.r, apart.g, apart.b, apart.a});
                if (std::abs(range - tolerance) < 1e-4) continue;  // rounding decides
                (range > tolerance ? drawn : interpolated) += 1;
                for (uint32_t i = 0; i < 8; ++i) {
                    const uint32_t px = x + i % 4, py = y + i / 4;
                    const glm::dvec4 expected = range > tolerance ? at(every, px, py) : between(every, px, py);
                    const double bound = range > tolerance ? 0.0 : 5e-6;
                    wrong += glm::any(glm::greaterThan(glm::abs(at(some, px, py) - expected), glm::dvec4(bound)));
                }
            }
        CHECK(wrong == 0);
        CHECK(drawn > 100);
        CHECK(interpolated > 100);
    }
}

TEST_CASE_FIXTURE(Adaptive, "parts of an adaptive picture have the bits of one drawn whole, wherever they begin")
{
    const ImageF whole = picture(0.05).image;
    const glm::uvec2 size(width(), height());
    for (const glm::uvec2& cut : {glm::uvec2(23, 17), glm::uvec2(66, 34), glm::uvec2(1, 90)}) {
        const std::pair<glm::uvec2, glm::uvec2> parts[] = {
            {{0, 0}, cut}, {{cut.x, 0}, {size.x, cut.y}}, {{0, cut.y}, {cut.x, size.y}}, {cut, size}};
        for (const auto& [begin, end] : parts)
            CHECK(differing_rows(renderer(), session, camera, whole, begin, end) == 0);
    }
}

TEST_CASE_FIXTURE(Adaptive, "everything that is drawn beside the volume is in an adaptive picture")
{
    session.light.shaded = true;
    ProbeLook probe{.center = {20, 16, 25}, .radius = 9.0, .color = {0.9, 0.1, 0.1}};
    probe.ball_opacity = 0.5;
    probe.shell = ShellLook{.threshold = 40000.0, .opacity = 0.7};
    const auto preview = std::make_shared<PaintPreview>();
    preview->box = {{12, 8, 17}, {28, 24, 33}};
    preview->words.assign(size_t(preview->words_per_row()) * 16 * 16, 0x0ff0u);
    preview->voxels = 8 * 16 * 16;

    CHECK(different() == 0);
    renderer().scene().set_surfaces({{{5, 5, 5}, {35, 25, 40}, 2.0, 5.0, GREEN}});
    CHECK(different() == 0);
    CHECK(different({.probe = probe}) == 0);
    probe.preview = preview;
    CHECK(different({.probe = probe}) == 0);
    session.view.arrangement = Arrangement::stereo;
    session.view.stereo.output = StereoOutput::anaglyph;
    CHECK(different({.probe = probe}) == 0);
}

TEST_CASE_FIXTURE(Adaptive, "long rays go on in the blocks that are drawn as in a whole picture")
{
    show(waves({900, 16, 16}));
    session = plain_session(busy_points(0.002), {40, 30});
    session.render.step_voxels = 0.02;
    camera = camera_along(volume(), {1, 0, 0}, 12.0);
    CHECK(different() == 0);
    const auto raycasts = [](const Picture& picture, const char* name) {
        return std::ranges::count(picture.graph.passes(), name, &PassData::name);
    };
    const Picture some = picture(TINY);
    CHECK(raycasts(some, "raycast") > 1);
    CHECK(raycasts(some, "raycast coarse") == raycasts(some, "raycast"));
}

TEST_CASE_FIXTURE(Adaptive, "blocks fill as many dispatches as they need, whatever the picture's size")
{
    show(noise_volume({40, 33, 50}, 61));  // hardly a block is level
    session.render.size = {601, 303};
    camera = camera_along(volume(), {0, 0, 1}, 15.0);  // nothing but the volume
    const Picture every = picture(0.0, {.count_work = true}), some = picture(0.01, {.count_work = true});
    CHECK(pass_of(some, "raycast").dispatches > 1);
    const auto rays = [](const Picture& picture, const char* name) {
        return double(pass_of(picture, name).counters[gpu::COUNTER_RAYS]);
    };
    const double all = rays(every, "raycast");
    CHECK(all == 601 * 303);
    CHECK(rays(some, "raycast") > 0.9 * all);
    CHECK(rays(some, "raycast") <= all);
    CHECK(std::abs(rays(some, "raycast coarse") - 0.25 * all) < 0.02 * all);
    size_t differing = 0;
    for (size_t i = 0; i < every.image.rgba.size(); i += 4)
        differing += std::memcmp(&every.image.rgba[i], &some.image.rgba[i], 16) != 0;
    CHECK(differing < every.image.rgba.size() / 4 / 20);
}

TEST_CASE_FIXTURE(Adaptive, "a level picture takes a quarter of the rays, and slices are drawn as ever")
{
    show(constant_volume({40, 33, 50}, 20000.0));
    camera = camera_along(volume(), {0, 0, 1}, 20.0);  // nothing but the volume, everywhere the same
    session.render.size = {160, 120};
    const Picture some = picture(0.01, {.count_work = true});
    CHECK(pass_of(some, "raycast").counters[gpu::COUNTER_RAYS] == 0);
    CHECK(pass_of(some, "raycast coarse").counters[gpu::COUNTER_RAYS] == 81 * 61);
    CHECK(worst_difference(pixels_of(some.image), pixels_of(picture(0.0).image)) < 1e-5);

    session.view.arrangement = Arrangement::slices;
    const Picture slices = picture(0.01);
    CHECK(std::ranges::count(slices.passes, "adaptive", &gpu::PassReport::name) == 1);  // the camera's pane
}
