// Any device budget from 16 MiB on draws the same bits as a large one: in smaller parts, with fewer bricks.

#include <functional>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "engine/picture/picture_job.h"
#include "tests/support/gpu.h"
#include "tests/support/slow.h"
#include "tests/support/stored_volume.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Source = std::shared_ptr<const VolumeSource>;
constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};
constexpr uint64_t LARGE_MIB = 1024;

struct Scenery {
    Session session;
    RenderOptions options;
    Document document;
    std::optional<Camera> camera{};  ///< null: from the front
    bool is_crowded = false;         ///< a small budget has no room for the bricks of one ray
};

Scenery scenery_of(const VolumeInfo& info, const glm::uvec2& pixels)
{
    Scenery scenery{.session = {}, .options = {}, .document = {Mask(info.size), TraceGraph{}}};
    scenery.session.transfer_function = TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0},
                                                          {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3},
                                                          {255.0, glm::dvec3(1.0), 0.6}});
    scenery.session.light.shaded = true;
    scenery.session.render.size = pixels;
    scenery.session.render.sampling = Sampling::exact;
    return scenery;
}

Mask painted_mask(const Size3& size, int64_t every)
{
    Mask mask(size);
    const glm::i64vec3 counts = mask.brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; brick += every)
        mask.apply({.brick = brick, .runs = {{.first = 9000, .last = 21000, .before = 0, .after = 3}}},
                   Direction::forwards);
    return mask;
}

ProbeLook probe_at(const glm::dvec3& center)
{
    const Change change =
        MaskBrickChange{.brick = 0, .runs = {{.first = 20000, .last = 21500, .before = 0, .after = 3}}};
    ProbeLook probe{.center = center, .radius = 20.0, .color = {0.9, 0.4, 0.1}, .ball_share = 0.4};
    probe.shell = ShellLook{.threshold = 110.0};
    probe.preview = std::make_shared<PaintPreview>(preview_of({&change, 1}, Size3(128), PaintPreview::Kind::group));
    return probe;
}

/// A renderer with its own budget, as the command line uses one.
Picture picture_of(const Source& source, const Scenery& scenery, uint64_t device_mib)
{
    Renderer renderer({.device = {.validation = true}, .budget = {device_mib << 20, 0}, .threads = 2});
    renderer.load(source, BYTES, scenery.session.render, shows_occlusion(scenery.session.light));
    renderer.scene().show(scenery.document);
    renderer.scene().show_surfaces(scenery.session.surfaces, scenery.document.trace, scenery.session.groups);
    const Camera camera = scenery.camera.value_or(camera_looking("front", source->info()));
    Picture picture = renderer.render(scenery.session, camera, scenery.options);
    CHECK(renderer.memory().peak_device_bytes() <= device_mib << 20);
    if (scenery.is_crowded && device_mib < LARGE_MIB) CHECK(renderer.volume().counts()->evictions > 0);
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    return picture;
}

/// Every day under the first budget, the one that is most of a challenge.
void check_budgets(const char* name, const Source& source, const Scenery& scenery,
                   const std::vector<uint64_t>& device_mib)
{
    CAPTURE(std::string(name));
    const Picture expected = picture_of(source, scenery, LARGE_MIB);
    CHECK(expected.complete);
    for (const uint64_t mib : std::span(device_mib).first(repeats(size_t{1}, device_mib.size()))) {
        CAPTURE(mib);
        const Picture seen = picture_of(source, scenery, mib);
        for (const std::string& warning : seen.warnings) FAIL_CHECK(warning);
        CHECK(seen.complete);
        CHECK(different_bits(seen.image, expected.image) == 0);
    }
}

}  // namespace

TEST_CASE("pictures larger than a device's budget have the bits of those under a large one")
{
    const Source source = stored_volume("tubes", {128, 128, 128}, 3);
    check_budgets("a megapixel", source, scenery_of(source->info(), {1024, 1024}), {32, 16});
    check_budgets("wide", source, scenery_of(source->info(), {3000, 300}), {64});
}

TEST_CASE("every kind of picture has the same bits under every budget")
{
    const Source source = stored_volume("tubes", {128, 128, 128}, 3);
    const Scenery plain = scenery_of(source->info(), {240, 200});
    const std::pair<const char*, std::function<void(Scenery&)>> kinds[] = {
        {"slices", [](Scenery& s) { s.session.view.arrangement = Arrangement::slices; }},
        {"pre-integration", [](Scenery& s) { s.session.render.preintegration = true; }},
        {"ambient occlusion",
         [](Scenery& s) { s.session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2}; }},
        {"paint, surfaces and the probe, in two colours",
         [&](Scenery& s) {
             s.document.mask = painted_mask(source->info().size, 3);
             s.session.surfaces = {{{10, 10, 10}, {100, 90, 95}, 2.0, 8.0, glm::dvec3(0.1, 0.9, 0.3)}};
             s.session.view.arrangement = Arrangement::stereo;
             s.session.view.stereo.output = StereoOutput::anaglyph;
             s.options.probe = probe_at({64.0, 30.0, 64.0});
             s.options.outlines_probe = true;
         }},
    };
    for (const auto& [name, change] : kinds) {
        Scenery scenery = plain;
        change(scenery);
        check_budgets(name, source, scenery, {16, 24, 64});
    }
}

TEST_CASE("a volume that a budget does not hold is drawn as fine as one that is resident")
{
    // 1000 bricks: 80 MB.
    const Source source = stored_volume("tubes", {320, 320, 320}, 3);
    Scenery scenery = scenery_of(source->info(), {96, 80});
    check_budgets("from afar", source, scenery, {16, 64});
    Scenery lit = scenery;
    lit.session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2};
    check_budgets("with ambient occlusion", source, lit, {24, 16, 64});
    scenery.document.mask = painted_mask(source->info().size, 6);  // 5.4 MB
    check_budgets("painted", source, scenery, {16, 24});
}

TEST_CASE("a ray passes more bricks than there is room for")
{
    // 232 bricks along x, each of which shows something; a budget of 16 MiB has room for 199.
    const Source source = stored_volume("fog", {7424, 34, 20}, 5);
    Scenery plain = scenery_of(source->info(), {2, 2});
    plain.session.light.shaded = false;
    plain.session.transfer_function = TransferFunction({{50.0, glm::dvec3(0.9, 0.2, 0.1), 1e-4},
                                                        {110.0, glm::dvec3(0.2, 0.9, 0.3), 5e-4},
                                                        {170.0, glm::dvec3(0.3, 0.4, 1.0), 2e-4}});
    plain.camera = camera_along({.size = {7424, 34, 20}}, {1.0, 0.001, 0.0005}, 16.0);
    plain.is_crowded = true;
    // Most of the time goes into preparing a device and its kernels for each, so what goes together is drawn together.
    const std::pair<const char*, std::function<void(Scenery&)>> kinds[] = {
        {"translucent, two eyes, less colour",
         [](Scenery& s) {
             s.session.render.saturation = 0.5;
             s.session.view.arrangement = Arrangement::stereo;
             s.session.view.stereo.output = StereoOutput::anaglyph;
         }},
        {"pre-integration and paint, an opaque surface far behind",
         [](Scenery& s) {
             s.session.render.preintegration = true;
             s.session.surfaces = {{{7300, 17, 10}, {7300, 17, 10}, 6.0, 6.0, glm::dvec3(0.1, 0.9, 0.3)}};
             s.document.mask.apply({.brick = 100, .runs = {{.first = 9000, .last = 19000, .before = 0, .after = 3}}},
                                   Direction::forwards);
         }},
        {"an iso-surface",
         [](Scenery& s) {
             s.options.probe = ProbeLook{.center = {3712.0, 17.0, 10.0},
                                         .radius = 3900.0,
                                         .color = RED,
                                         .ball_share = 0.0,
                                         .shell = ShellLook{.threshold = 110.0, .opacity = 0.01, .is_box = true}};
         }},
        {"shading and ambient occlusion",
         [](Scenery& s) {
             s.session.light.shaded = true;
             s.session.light.occlusion = {.strength = 1.0, .radius = 24.0, .rays = 1, .curve = 50.0};
             // Light costs by the voxels that show: every day those are a third, in each brick some.
             if (!is_slow())
                 s.session.transfer_function = TransferFunction(
                     {{118.0, glm::dvec3(0.9, 0.2, 0.1), 0.0}, {150.0, glm::dvec3(0.3, 0.4, 1.0), 1e-3}});
         }},
    };
    for (const auto& [name, change] : kinds) {
        Scenery scenery = plain;
        change(scenery);
        check_budgets(name, source, scenery, {16});
    }
}

// Kind (Drivers): ambient occlusion at the smallest budget of device memory
TEST_CASE("light that comes from more bricks than there is room for is told, and the picture is drawn without it")
{
    // 125 bricks, all of them within two of the middle one.
    const Source source = stored_volume("fog", {160, 160, 160}, 5);
    Scenery scenery = scenery_of(source->info(), {12, 10});
    scenery.session.light.occlusion = {.strength = 1.0, .radius = 40.0, .rays = 2};
    const Picture picture = picture_of(source, scenery, 16);
    CHECK_FALSE(picture.complete);
    REQUIRE(picture.warnings.size() == 1);
    CHECK(picture.warnings[0].find("ambient light comes to a brick from 125 bricks, and a device budget of 16 MiB has "
                                   "room for ") == 0);
}

TEST_CASE("what no budget of this size draws is refused before a voxel is read")
{
    // No voxel of these is read, since that would take too long: 2^30 voxels, a level of 4096 bricks.
    const Source deep = open_procedural({.kind = "fog", .size = {1024, 1024, 1024}, .levels = 2});
    const Source flat = open_procedural({.kind = "fog", .size = {512, 512, 512}});
    const auto said = [&](Paging paging, uint64_t mib) -> std::string {
        Renderer renderer({.device = {.validation = true}, .budget = {mib << 20, 0}, .threads = 1});
        try {
            renderer.check_sizes(paging == Paging::never ? *flat : *deep, {.paging = paging}, false);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    CHECK(said(Paging::automatic, 4096) == "");
    CHECK(said(Paging::automatic, 16).find("its coarsest level has 4096 bricks and the device has room for ") !=
          std::string::npos);
    CHECK(said(Paging::automatic, 6).find("a picture needs ") != std::string::npos);
    CHECK(said(Paging::never, 160).find("render.paging is never, and its bricks need ") != std::string::npos);
}

TEST_CASE("paint that a budget does not hold is refused in one sentence with a remedy")
{
    const Source source = stored_volume("tubes", {320, 320, 320}, 3);
    Scenery scenery = scenery_of(source->info(), {16, 16});
    scenery.document.mask = painted_mask(source->info().size, 1);
    try {
        static_cast<void>(picture_of(source, scenery, 16));
        FAIL_CHECK("is not refused");
    } catch (const gpu::BudgetError& error) {
        const std::string said = error.what();
        CAPTURE(said);
        const size_t at = said.find("--budget-device ");
        REQUIRE(at != std::string::npos);
        CHECK(said.find("paint") != std::string::npos);
        const auto mib = uint64_t(std::stoi(said.substr(at + 16)));
        CHECK(mib > 32);
        CHECK(mib < 128);
        check_budgets("as advised", source, scenery, {mib});
    }
}

TEST_CASE("bands of rows have the bits of a picture drawn whole, lines over them included")
{
    const Source source = stored_volume("tubes", {48, 48, 48}, 3);
    Scenery scenery = scenery_of(source->info(), {600, 301});
    scenery.options = {.probe = probe_at({24.0, 20.0, 24.0}), .outlines_probe = true};
    scenery.options.probe->preview = nullptr;
    for (const Arrangement arrangement : {Arrangement::single, Arrangement::overview, Arrangement::slices}) {
        scenery.session.view.arrangement = arrangement;
        const ImageF whole = picture_of(source, scenery, LARGE_MIB).image;
        Renderer renderer({.device = {.validation = true}, .budget = {0, 4 << 20}, .threads = 1});
        renderer.load(source, BYTES, scenery.session.render);
        ImageF image{600, 0, {}};
        int bands = 0;
        PictureJob job(renderer, scenery.session, camera_looking("front", source->info()), scenery.options,
                       [&](const ImageF& rows) {
                           image.height += rows.height;
                           image.rgba.insert(image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
                           ++bands;
                       });
        while (!job.is_done()) job.step();
        CHECK(job.take().complete);
        CHECK(bands >= 8);
        REQUIRE(image.height == 301);
        CHECK(different_bits(image, whole) == 0);
        CHECK(renderer.peak_host_bytes() <= uint64_t{4} << 20);
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
}
