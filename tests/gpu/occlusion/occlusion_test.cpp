// Local ambient occlusion as computed by the device: its values against the definition in double, and what invalidates
// them. tests/unit/device/occlusion_test.cpp tests the definition itself.

#include "engine/passes/occlusion.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "engine/live/view.h"
#include "engine/volume/procedural/source_procedural.h"
#include "tests/support/nap.h"
#include "tests/support/occlusion.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// The precision of a device's 8 bits, and a voxel whose code rounds the other way.
constexpr double STORED = 0.5 / 255.0;
constexpr double ROUNDED_OTHERWISE = 1.6 / 255.0;

/// Compares some of the volume's visible voxels with the definition.
void check_values(OnDevice& device, const Session& session, size_t every)
{
    device.draw(session, overview(device.volume()));
    const std::vector<double> values = occlusion_values(device);
    const ExpectedOcclusion expected(device.volume(), session);
    const glm::ivec3 size = device.volume().size;
    size_t seen = 0, far = 0;
    double worst = 0.0;
    for (size_t i = 0; i < values.size(); i += every) {
        const glm::ivec3 voxel(int(i) % size.x, int(i) / size.x % size.y, int(i) / (size.x * size.y));
        if (expected.opacity(voxel) == 0.0) continue;
        const double error = std::abs(values[i] - expected.by_taps(voxel));
        ++seen;
        far += error > STORED + 1e-4;
        worst = std::max(worst, error);
    }
    CHECK(seen > 50);
    CHECK(double(far) <=
          0.02 * double(seen));  // a ray that passes the border of two voxels, a code in the middle of two
    check_below("worst value", worst, ROUNDED_OTHERWISE);
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice,
                  "ambient occlusion is the definition's, for dense and thin things, near borders and across bricks")
{
    const std::vector<ControlPoint> dense{{36000.0, RED, 0.0}, {42000.0, RED, 0.9}, {65535.0, RED, 1.0}};
    const std::vector<ControlPoint> thin{{20000.0, RED, 0.0}, {65535.0, RED, 0.08}};
    load(blobs({70, 41, 50}));
    check_values(*this, occluded(dense), 29);
    check_values(*this, occluded(thin), 61);
    check_values(*this, occluded(dense, 1.0), 61);
    check_values(*this, occluded(dense, 5.3), 61);
    Session beyond = occluded(dense, 40.0);  // the volume's border
    beyond.light.occlusion.rays = 5;
    check_values(*this, beyond, 61);
    Session full = occluded(dense);
    full.light.occlusion.full_sphere = true;
    full.light.occlusion.rays = 7;
    check_values(*this, full, 29);
    Session cut = occluded(dense);
    cut.cut = {{20.0, 3.5, 11.0}, {64.0, 39.0, 37.0}};
    check_values(*this, cut, 29);
    cut.cut.plane_normal = glm::dvec3(0.31, -1.0, 0.77);
    cut.cut.plane_point = glm::dvec3(35.2, 20.7, 25.1);
    check_values(*this, cut, 29);
    load(blobs({36, 30, 20}, {1.0, 1.5, 2.5}));
    check_values(*this, occluded(dense), 13);
}

TEST_CASE_FIXTURE(OnDevice, "a radius below a voxel keeps no light off, and neither does a strength of 0")
{
    load(blobs({40, 40, 40}));
    const Camera camera = overview(volume());
    Session off = occluded(busy_points());
    off.light.occlusion.strength = 0.0;
    const ImageF without = draw(off, camera);
    CHECK(different_bits(without, draw(occluded(busy_points(), 0.7), camera)) == 0);
    CHECK(different_bits(without, draw(occluded(busy_points()), camera)) > 1000);
}

TEST_CASE_FIXTURE(OnDevice, "what is off costs no pass and no byte, and what is switched off gives its memory back")
{
    load(blobs({40, 40, 40}));
    const Camera camera = overview(volume());
    Session session = occluded(busy_points());
    session.light.occlusion.strength = 0.0;
    const auto passes = [&] {
        std::vector<std::string> names;
        for (const gpu::PassReport& pass : renderer().render(session, camera).passes) names.push_back(pass.kernel);
        return names;
    };
    static_cast<void>(passes());
    const std::vector<std::string> before = passes();
    const uint64_t bytes = renderer().memory().device_bytes();
    for (const std::string& kernel : before) CHECK(kernel.find("occlu") == std::string::npos);
    session.light.occlusion.strength = 0.5;
    const std::vector<std::string> with = passes();
    CHECK(std::ranges::find(with, "occlusion_bake") != with.end());
    CHECK(std::ranges::find(with, "raycast_occluded") != with.end());
    CHECK(renderer().memory().device_bytes() > bytes);
    const std::vector<std::string> again = passes();  // nothing is computed twice
    CHECK(std::ranges::find(again, "occlusion_bake") == again.end());
    session.light.occlusion.strength = 0.0;
    CHECK(passes() == before);
    CHECK(renderer().memory().bytes_by_name().count("occlusion values") == 0);
    CHECK(renderer().memory().bytes_by_name().count("occlusion cells") == 0);
    CHECK(renderer().memory().bytes_by_name().count("occlusion scratch") == 0);
}

TEST_CASE_FIXTURE(OnDevice, "a change rebuilds what rebuilding everything gives, bit for bit")
{
    const TestVolume scene = blobs({110, 70, 66});
    load(scene);
    const Camera camera = overview(volume());
    Session session = occluded({{44000.0, RED, 0.0}, {50000.0, GREEN, 0.9}, {65535.0, BLUE, 1.0}}, 9.0);
    session.light.occlusion.rays = 4;
    session.groups[2] = {.name = "two", .color = BLUE, .opacity = 0.7, .visible = true};
    static_cast<void>(draw(session, camera));
    Annotator annotator(renderer());
    std::mt19937 random(71);  // seed 71
    const auto below = [&](int end) { return int(random() % uint32_t(end)); };
    for (int trial = 0; trial < repeats(5, 10); ++trial) {
        CAPTURE(trial);
        const uint64_t before = renderer().scene().occlusion().counts().values;
        switch (trial % 5) {
            case 0:
            case 1:
                annotator.paint({.brush = Brush::fill,
                                 .group = uint8_t(1 + trial % 3),
                                 .radius_voxels = 2.0 + below(6),
                                 .path = {{below(110), below(70), below(66)}}});
                break;
            case 2: session.groups[2].visible = !session.groups[2].visible; break;
            case 3:
                session.cut.lower = glm::dvec3(below(20), below(20), below(20));
                session.cut.plane_normal = glm::dvec3(1.0, 0.1 * below(20), -0.3);
                session.cut.plane_point = glm::dvec3(90.3, below(70), 33.0);
                break;
            default: annotator.undo(); break;
        }
        const ImageF renewed = draw(session, camera);
        const uint64_t made = renderer().scene().occlusion().counts().values - before;
        if (trial < 2) CHECK(made < 36);
        renderer().scene().occlusion().clear();
        check_below("differing bits", double(different_bits(renewed, draw(session, camera))), 0.0);
    }
}

TEST_CASE_FIXTURE(OnDevice, "a look's light does not depend on the looks before it")
{
    load(blobs({70, 41, 50}));
    const Camera camera = overview(volume());
    std::vector<Session> sessions(5, occluded(busy_points(), 12.0));
    sessions[1].transfer_function = TransferFunction({{40000.0, RED, 0.0}, {50000.0, GREEN, 1.0}});
    sessions[2].light.occlusion.radius = 5.0;
    sessions[3].light.occlusion.rays = 9;
    sessions[4].light.occlusion.full_sphere = true;
    std::vector<ImageF> alone;
    for (const Session& session : sessions) {
        renderer().scene().occlusion().clear();
        alone.push_back(draw(session, camera));
    }
    for (size_t i = 0; i < sessions.size(); ++i) {
        CAPTURE(i);
        check_below("differing bits", double(different_bits(alone[i], draw(sessions[i], camera))), 0.0);
        if (i > 0) CHECK(different_bits(alone[i], alone[0]) > 100);
    }
}

TEST_CASE_FIXTURE(OnDevice, "strength and curve act on what is made, and all light stays all light")
{
    load(blobs({40, 40, 40}));
    const Camera camera = overview(volume());
    const auto mean = [&](double strength, double curve) {
        Session session = occluded({{36000.0, WHITE, 0.0}, {42000.0, WHITE, 0.9}, {65535.0, WHITE, 1.0}});
        session.light.occlusion.strength = strength;
        session.light.occlusion.curve = curve;
        double sum = 0.0;
        for (const glm::dvec4& pixel : pixels_of(draw(session, camera))) sum += pixel.r;
        return sum;
    };
    const double off = mean(0.0, 1.0), half = mean(0.5, 1.0), full = mean(1.0, 1.0), dark = mean(1.0, 3.0);
    CHECK(half < 0.95 * off);
    CHECK(half == doctest::Approx(0.5 * (off + full)).epsilon(1e-4));
    CHECK(dark < 0.9 * full);
    load(constant_volume({40, 40, 40}, 1000.0));  // nearly empty space blocks no light
    Session clear = occluded(uniform_points(WHITE, 1e-5));
    const ImageF with = draw(clear, camera);
    clear.light.occlusion.strength = 0.0;
    check_below("clear medium", worst_difference(pixels_of(with), pixels_of(draw(clear, camera))), 2e-6);
}

TEST_CASE_FIXTURE(OnDevice, "a curve of points maps the light that arrives as its power does, or as nothing else can")
{
    load(blobs({40, 40, 40}));
    const Camera camera = overview(volume());
    const auto drawn = [&](std::vector<OcclusionPoint> mapping, double curve = 1.0, double strength = 1.0) {
        Session session = occluded({{36000.0, WHITE, 0.0}, {42000.0, WHITE, 0.9}, {65535.0, WHITE, 1.0}});
        session.light.occlusion.strength = strength;
        session.light.occlusion.curve = curve;
        session.light.occlusion.mapping = std::move(mapping);
        return pixels_of(draw(session, camera));
    };
    const auto even = drawn({{0.0, 0.0}, {0.25, 0.25}, {1.0, 1.0}}, 3.0);  // the points go before the power
    check_below("the line of all light", worst_difference(even, drawn({})), 1e-6);
    std::vector<OcclusionPoint> square;
    for (int i = 0; i < 16; ++i) square.push_back({i / 15.0, i * i / 225.0});
    // 16 points are off a square by 1/900 at most.
    check_below("a square in 16 points", worst_difference(drawn(square), drawn({}, 2.0)), 2e-3);
    // All light for voxels that are lit more than half, and none for the rest: a step, whose mean over the picture
    // lies between.
    const auto bright = drawn({{0.0, 1.0}}), dark = drawn({{0.5, 0.0}}), step = drawn({{0.5, 0.0}, {0.5, 1.0}});
    check_below("all light", worst_difference(bright, drawn({}, 1.0, 1e-9)), 1e-5);
    size_t like_bright = 0, like_dark = 0;
    for (size_t i = 0; i < step.size(); ++i) {
        like_bright += bright[i].r > dark[i].r + 0.05 && std::abs(step[i].r - bright[i].r) < 0.01;
        like_dark += bright[i].r > dark[i].r + 0.05 && std::abs(step[i].r - dark[i].r) < 0.01;
    }
    CHECK(like_bright > 20);
    CHECK(like_dark > 20);
}

TEST_CASE_FIXTURE(OnDevice, "a volume in bricks is lit as a paged one is, and as filtered ones nearly are")
{
    Session session = occluded({{36000.0, RED, 0.0}, {42000.0, GREEN, 0.9}, {65535.0, BLUE, 1.0}}, 12.0);
    session.light.occlusion.rays = 8;
    const TestVolume scene = blobs({100, 70, 66});
    load(scene);
    const Camera camera = overview(scene);
    const ImageF resident = draw(session, camera);
    load(scene, Sampling::hardware);
    check_below("hardware filter", rms_difference(pixels_of(resident), pixels_of(draw(session, camera))), 4e-3);
    RenderSettings paged = session.render;
    paged.paging = Paging::always;
    VolumeStatistics statistics = measure(*source_of(scene));
    statistics.minimum = scene.minimum;
    statistics.maximum = scene.maximum;
    renderer().load(source_of(scene), statistics, paged);
    Session finest = session;
    finest.render.detail = 0.0;
    const Picture picture = renderer().render(finest, camera);
    CHECK(picture.complete);
    check_below("differing bits", double(different_bits(resident, picture.image)), 0.0);
}

TEST_CASE_FIXTURE(OnDevice, "a view that rests shows what a picture shows, and then submits nothing")
{
    load(blobs({70, 41, 50}));
    const Camera camera = overview(volume());
    Session session = occluded({{36000.0, RED, 0.0}, {42000.0, GREEN, 0.9}, {65535.0, BLUE, 1.0}}, 12.0, {96, 80});
    View view(renderer());
    const auto rest = [&] {
        for (int i = 0; !view.complete(); ++i) {
            nap(i);
            REQUIRE(i < 100'000'000);
            view.advance();
        }
        const uint64_t submissions = view.submissions();
        for (int i = 0; i < 10; ++i) view.advance();
        CHECK(view.submissions() == submissions);
    };
    // Encoded on the device or on the host, a channel may round differently.
    const auto is_picture = [&](const Image8& shown) {
        const Image8 expected = to_image8(draw(session, camera));
        return compare_pixels(shown, expected).max_abs <= 1.0;
    };
    view.look(session, camera, session.render.size);
    rest();
    const Image8 seen = view.read_back();
    CHECK(is_picture(seen));

    SUBCASE("another look")
    {
        session.transfer_function = TransferFunction({{30000.0, RED, 0.0}, {42000.0, GREEN, 0.5}});
        view.look(session, camera, session.render.size);
        rest();
        CHECK(is_picture(view.read_back()));
    }
    SUBCASE("by hand")
    {
        session.light.occlusion.automatic = false;
        session.light.occlusion.radius = 5.0;
        view.look(session, camera, session.render.size);
        rest();
        CHECK(view.read_back().rgba == seen.rgba);
        view.update_occlusion();
        view.advance();
        rest();
        const Image8 renewed = view.read_back();
        CHECK(renewed.rgba != seen.rgba);
        CHECK(is_picture(renewed));
    }
}

TEST_CASE_FIXTURE(OnDevice, "asking what is due looks at a brick again only where something about it has changed")
{
    // Most of the 4 * 3 * 3 bricks are empty: they never get values, and queries about them never end.
    load(volume_of({128, 96, 96}, [](const glm::dvec3& p) { return p.x < 40.0 ? 50000.0 : 0.0; }));
    const Session session = occluded({{36000.0, RED, 0.0}, {42000.0, GREEN, 0.9}, {65535.0, BLUE, 1.0}}, 6.0, {64, 64});
    static_cast<void>(draw(session, overview(volume())));
    Occlusion& occlusion = renderer().scene().occlusion();
    CHECK_FALSE(occlusion.is_due());
    const uint64_t looks = occlusion.counts().looks, walks = occlusion.counts().walks;
    CHECK(looks > 0);
    for (int i = 0; i < 100; ++i) CHECK_FALSE(occlusion.is_due());
    CHECK(occlusion.counts().looks == looks);
    CHECK(occlusion.counts().walks == walks);  // nor asks any at all
    // Paint in one corner: its brick and those beside it.
    Annotator annotator(renderer());
    annotator.paint({.brush = Brush::fill, .group = 2, .radius_voxels = 3.0, .path = {{6, 6, 6}}});
    CHECK(occlusion.is_due());
    static_cast<void>(draw(session, overview(volume())));
    CHECK_FALSE(occlusion.is_due());
    CHECK(occlusion.counts().looks - looks <= 16);
}

TEST_CASE("where occlusion has no room the picture goes without, and says so once")
{
    const std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "tubes", .size = Size3(200)});
    Session session;
    session.render = {.size = {48, 48}, .sampling = Sampling::exact};
    session.transfer_function = TransferFunction({{90.0, glm::dvec3(1.0), 0.0}, {200.0, glm::dvec3(1.0), 0.5}});
    gpu::DeviceOptions device;
    device.validation = true;
    // The volume takes nearly all memory.
    Renderer renderer({.device = device, .budget = {.device_bytes = uint64_t{28} << 20}});
    renderer.load(source, measure(*source), session.render);
    REQUIRE(!renderer.volume().counts());
    const Camera camera = camera_looking("front", source->info());
    const Picture plain = renderer.render(session, camera);
    CHECK(plain.complete);
    session.light.occlusion.strength = 1.0;
    const Picture without = renderer.render(session, camera);
    CHECK_FALSE(without.complete);
    REQUIRE(without.warnings.size() == 1);
    CHECK(without.warnings[0].find("ambient occlusion is not drawn: device memory") == 0);
    CHECK(without.image.rgba == plain.image.rgba);
    CHECK(renderer.render(session, camera).warnings.empty());
    // Told in advance, the volume leaves room: it is paged.
    renderer.load(source, measure(*source), session.render, true);
    REQUIRE(renderer.volume().counts());
    const Picture with = renderer.render(session, camera);
    CHECK(with.complete);
    CHECK(with.warnings.empty());
    CHECK(with.image.rgba != plain.image.rgba);
    // Smaller volumes have room.
    const std::shared_ptr<const VolumeSource> small = open_procedural({.kind = "tubes", .size = Size3(64)});
    renderer.load(small, measure(*small), session.render);
    CHECK(renderer.render(session, camera_looking("front", small->info())).complete);
    CHECK(renderer.device().take_validation_messages().empty());
}
