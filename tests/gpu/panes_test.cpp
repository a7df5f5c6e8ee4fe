// Pictures of several panes: two eyes, maps, slices; resident and with paged bricks.

#include <cmath>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

ImageF part_of(const ImageF& image, const PixelBox& box)
{
    ImageF part{int(box.end.x - box.begin.x), int(box.end.y - box.begin.y), {}};
    for (uint32_t y = box.begin.y; y < box.end.y; ++y) {
        const auto row = image.rgba.begin() + 4 * (ptrdiff_t(box.begin.x) + ptrdiff_t(image.width) * y);
        part.rgba.insert(part.rgba.end(), row, row + 4 * part.width);
    }
    return part;
}

Session sliced(const std::vector<ControlPoint>& points, const glm::uvec2& size)
{
    Session session = plain_session(points, size);
    session.view.arrangement = Arrangement::slices;
    session.render.background = {0.25, 0.5, 0.75, 1.0};
    return session;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "slices are the voxels in their plane, whatever the transfer function hides")
{
    TestVolume noise = noise_volume({40, 33, 50}, 4);
    noise.spacing = {1.0, 1.5, 0.75};
    load(noise);
    Session session = sliced(unseen_points(), {96, 80});
    session.probe.voxel = glm::dvec3(11.25, 20.5, 37.8);
    session.view.slices.black = 8000.0;
    session.view.slices.white = 60000.0;
    session.cut.lower = {30.0, 30.0, 30.0};  // cuts the volume, but not the slices
    session.cut.plane_normal = glm::dvec3(1.0, 1.0, 1.0);
    const Camera camera = camera_along(volume(), {1, 1, 1}, 60.0);
    const ImageF image = draw(session, camera);
    double worst = 0.0;
    size_t inside_count = 0;
    for (const Pane& pane :
         panes_of(session.view, camera, session.render.size, volume().info(), *session.probe.voxel)) {
        if (pane.kind != Pane::Kind::slice) continue;
        const Camera& seen = pane.shot.camera;
        const glm::uvec2 pixels = pane.box.end - pane.box.begin;
        const ImageF part = part_of(image, pane.box);
        const auto cross = project(seen, pixels, *session.probe.voxel * noise.spacing);
        constexpr uint32_t BORDER = 3;  // lines between panes
        for (uint32_t y = BORDER; y < pixels.y; ++y)
            for (uint32_t x = BORDER; x < pixels.x; ++x) {
                const glm::dvec2 at = glm::dvec2(x, y) + 0.5;
                if (glm::any(glm::lessThan(glm::abs(at - cross->pixel), glm::dvec2(4.0)))) continue;  // the cross
                const glm::dvec3 voxel =
                    unproject(seen, pixels, at, 0.5 * (seen.near_distance + seen.far_distance)) / noise.spacing;
                const float* const pixel = &part.rgba[4 * size_t(x + pixels.x * y)];
                const glm::dvec3 size(noise.size);
                if (glm::any(glm::lessThan(voxel, glm::dvec3(-1e-3))) ||
                    glm::any(glm::greaterThan(voxel, size + 1e-3))) {
                    CHECK(glm::vec3(pixel[0], pixel[1], pixel[2]) == glm::vec3(0.25, 0.5, 0.75));
                } else if (glm::all(glm::greaterThan(voxel, glm::dvec3(1e-3))) &&
                           glm::all(glm::lessThan(voxel, size - 1e-3))) {
                    const double grey = std::clamp((value_at(noise, voxel) - 8000.0) / 52000.0, 0.0, 1.0);
                    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(srgb_decode(grey) - double(pixel[c])));
                    ++inside_count;
                }
            }
    }
    CHECK(inside_count > 2000);
    check_below("slices against trilinear values in double", worst, 3e-5);
}

TEST_CASE_FIXTURE(OnDevice, "paint lies over slices as thickly as it is told to")
{
    load(constant_volume({40, 40, 40}, 32768.0));
    Session session = sliced(unseen_points(), {80, 80});
    session.probe.voxel = glm::dvec3(20.5);
    session.groups[3] = {.color = glm::dvec3(1.0, 0.0, 0.0), .opacity = 0.125};
    Annotator annotator(renderer());
    PaintOp paint{.brush = Brush::fill, .region = RegionShape::box, .group = 3, .threshold = 100.0, .radius_voxels = 4};
    paint.path = {glm::dvec3(20.5)};
    REQUIRE(annotator.paint(paint) > 0);
    const Camera camera = camera_along(volume(), {1, 1, 1}, 60.0);
    const float grey = float(srgb_decode(32768.0 / 65535.0));
    const auto colors = [&](double share, bool visible) {
        session.view.slices.paint_share = share;
        session.groups[3].visible = visible;
        const ImageF image = draw(session, camera);
        const float* const pixel = &image.rgba[4 * size_t(40 + 20 + 3 + 80 * 17)];  // next to the cross
        return glm::vec3(pixel[0], pixel[1], pixel[2]);
    };
    const glm::vec3 half = colors(0.5, true);
    CHECK(half.r == doctest::Approx(0.5f * grey + 0.5f).epsilon(1e-4));
    CHECK(half.g == doctest::Approx(0.5f * grey).epsilon(1e-4));
    CHECK(colors(0.0, true).r == doctest::Approx(grey).epsilon(1e-4));
    CHECK(colors(0.5, false).r == doctest::Approx(grey).epsilon(1e-4));
}

TEST_CASE_FIXTURE(OnDevice, "each eye's pane is the picture of its camera, bit for bit")
{
    load(noise_volume({40, 33, 50}, 6));
    Session session = plain_session(busy_points(), {62, 48});
    session.light.shaded = true;
    session.blend = {.size = 0.5};
    const Camera camera = perspective({20, -90, 30}, {20, 16, 25}, 35.0);
    const auto [left, right] = eyes_of(camera, session.view.stereo);
    for (const StereoOutput output : {StereoOutput::side_by_side, StereoOutput::top_bottom}) {
        session.view.arrangement = Arrangement::stereo;
        session.view.stereo.output = output;
        const ImageF both = draw(session, camera);
        const glm::uvec2 half = output == StereoOutput::side_by_side ? glm::uvec2(31, 48) : glm::uvec2(62, 24),
                         second = glm::uvec2(62, 48) - half;
        Session mono = session;
        mono.view.arrangement = Arrangement::single;
        mono.render.size = half;
        check_below("differing bits", double(different_bits(part_of(both, {glm::uvec2(0), half}), draw(mono, left))),
                    0.0);
        check_below("differing bits", double(different_bits(part_of(both, {second, second + half}), draw(mono, right))),
                    0.0);
    }
    Session mono = session;
    mono.view.arrangement = Arrangement::single;
    session.view.stereo = {.output = StereoOutput::anaglyph};
    const ImageF glasses = draw(session, camera), red = draw(mono, left), cyan = draw(mono, right);
    size_t wrong = 0;
    for (size_t i = 0; i < glasses.rgba.size(); i += 4)
        wrong += glasses.rgba[i] != red.rgba[i] || glasses.rgba[i + 1] != cyan.rgba[i + 1] ||
                 glasses.rgba[i + 2] != cyan.rgba[i + 2];
    CHECK(wrong == 0);
    CHECK(different_bits(red, cyan) > 1000);
    session.view.stereo.eye_distance = 0.0;
    check_below("differing bits, eyes at no distance",
                double(different_bits(draw(session, camera), draw(mono, camera))), 0.0);
}

TEST_CASE_FIXTURE(OnDevice, "off-axis and toed-in rays are those of the reference")
{
    load(noise_volume({40, 33, 50}, 6));
    const Session session = plain_session(busy_points(), {24, 20});
    const Camera camera = perspective({20, -90, 30}, {20, 16, 25}, 35.0);
    for (const bool toe_in : {false, true}) {
        const auto [left, right] = eyes_of(camera, {.eye_distance = 0.1, .toe_in = toe_in});
        check_below("left", error(session, left), 2e-5);
        check_below("right", error(session, right), 2e-5);
    }
    // A point in space is drawn where `project` puts it: the reference uses the same rays, so this ties both to the
    // camera.
    load(volume_of({40, 33, 50}, [](const glm::dvec3& voxel) {
        return glm::distance(voxel, glm::dvec3(30.5, 8.5, 40.5)) < 1.0 ? 60000.0 : 0.0;
    }));
    const Session bright =
        plain_session({{20000.0, WHITE, 0.0}, {30000.0, WHITE, 1.0}, {65535.0, WHITE, 1.0}}, {96, 80});
    for (const auto& eye :
         {eyes_of(camera, {.eye_distance = 0.3}).first, eyes_of(camera, {.eye_distance = 0.3}).second}) {
        const ImageF image = draw(bright, eye);
        glm::dvec2 sum(0.0);
        double weight = 0.0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 96; ++x) {
                const double light = image.rgba[4 * size_t(x + 96 * y)];
                sum += light * (glm::dvec2(x, y) + 0.5);
                weight += light;
            }
        REQUIRE(weight > 0.5);
        CHECK(glm::distance(sum / weight, project(eye, {96, 80}, glm::dvec3(30.5, 8.5, 40.5))->pixel) < 0.5);
    }
}

TEST_CASE("panes are the same with paged bricks")
{
    const std::shared_ptr<const VolumeSource> tubes =
        open_procedural({.kind = "tubes", .size = {128, 128, 128}, .seed = 3});
    Session session;
    session.transfer_function =
        TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}});
    session.render.size = {96, 80};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    Renderer renderer({.device = {.validation = true}, .threads = 2});
    const auto drawn = [&](Paging paging) {
        session.render.paging = paging;
        renderer.load(tubes, {.minimum = 0.0, .maximum = 255.0}, session.render);
        const Picture picture = renderer.render(session, camera_looking("front", tubes->info()));
        CHECK(picture.complete);
        return picture.image;
    };
    for (const Arrangement arrangement : {Arrangement::slices, Arrangement::overview, Arrangement::stereo})
        for (const StereoOutput output : {StereoOutput::side_by_side, StereoOutput::anaglyph}) {
            if (arrangement != Arrangement::stereo && output == StereoOutput::anaglyph) continue;
            session.view.arrangement = arrangement;
            session.view.stereo.output = output;
            CHECK(different_bits(drawn(Paging::always), drawn(Paging::never)) == 0);
        }
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
}
