// Panes, the cameras of two eyes, and the lines over them.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

#include "engine/look/overlay.h"
#include "tests/support/bounds.h"

using namespace shvr;
using namespace shvr::test;

namespace {

Camera looking()
{
    Camera camera;
    camera.eye = {10.0, -90.0, 30.0};
    camera.target = {20.0, 15.0, 25.0};
    return camera;
}

ViewSettings arranged(Arrangement arrangement)
{
    return {.arrangement = arrangement};
}

}  // namespace

TEST_CASE("panes cover the picture once, the camera's first")
{
    const VolumeInfo volume = volume_of_size({40, 30, 50});
    for (const Arrangement arrangement :
         {Arrangement::single, Arrangement::stereo, Arrangement::overview, Arrangement::slices})
        for (const glm::uvec2 pixels : {glm::uvec2(64, 48), glm::uvec2(61, 33), glm::uvec2(16, 200)}) {
            std::vector<int> covered(size_t(pixels.x) * pixels.y);
            const std::vector<Pane> panes =
                panes_of(arranged(arrangement), looking(), pixels, volume, glm::dvec3(3, 4, 5));
            CHECK(panes[0].kind != Pane::Kind::slice);
            CHECK(panes[0].kind != Pane::Kind::map);
            for (const Pane& pane : panes)
                for (uint32_t y = pane.box.begin.y; y < pane.box.end.y; ++y)
                    for (uint32_t x = pane.box.begin.x; x < pane.box.end.x; ++x) ++covered[x + size_t(pixels.x) * y];
            CHECK(std::ranges::all_of(covered, [](int times) { return times == 1; }));
            CHECK((panes.size() == 1) == (arrangement == Arrangement::single || pixels.x < 32));
        }
}

TEST_CASE("off-axis eyes: disparity e f (1/c - 1/z), none in height")
{
    const Camera camera = looking();
    const glm::uvec2 pixels(640, 480);
    const StereoSettings settings{.eye_distance = 0.05};
    const auto [left, right] = eyes_of(camera, settings);
    const CameraAxes axes = axes_of(camera);
    const double c = glm::distance(camera.eye, camera.target), e = settings.eye_distance * c;
    const double f = 0.5 * pixels.y / std::tan(glm::radians(0.5 * camera.fov_y_degrees));  // pixels
    for (const double z : {0.5 * c, c, 1.5 * c, 100.0 * c})
        for (const glm::dvec2 aside : {glm::dvec2(0.0), glm::dvec2(7.0, -3.0), glm::dvec2(-20.0, 11.0)}) {
            const glm::dvec3 point = camera.eye + z * axes.forward + aside.x * axes.right + aside.y * axes.up;
            const glm::dvec2 in_left = project(left, pixels, point)->pixel;
            const glm::dvec2 in_right = project(right, pixels, point)->pixel;
            CAPTURE(z);
            CAPTURE(aside.x);
            test::check_below("disparity, pixels", std::abs(in_right.x - in_left.x - e * f * (1.0 / c - 1.0 / z)),
                              1e-9);
            test::check_below("in height, pixels", std::abs(in_right.y - in_left.y), 1e-9);
        }
}

TEST_CASE("toed-in eyes: the parallax in height that they are known for")
{
    const Camera camera = looking();
    const glm::uvec2 pixels(640, 480);
    const StereoSettings settings{.eye_distance = 0.1, .toe_in = true};
    const auto [left, right] = eyes_of(camera, settings);
    const CameraAxes axes = axes_of(camera);
    const double c = glm::distance(camera.eye, camera.target), half = 0.5 * settings.eye_distance * c;
    const double angle = std::atan2(half, c), f = 0.5 * pixels.y / std::tan(glm::radians(0.5 * camera.fov_y_degrees));
    for (const glm::dvec3 at : {glm::dvec3(0.0, 0.0, c), glm::dvec3(15.0, 9.0, 0.8 * c), glm::dvec3(-8.0, 20.0, c)}) {
        const glm::dvec3 point = camera.eye + at.x * axes.right + at.y * axes.up + at.z * axes.forward;
        const double in_left = project(left, pixels, point)->pixel.y, in_right = project(right, pixels, point)->pixel.y;
        const double expected = f * at.y *
                                (1.0 / (at.z * std::cos(angle) + (at.x + half) * std::sin(angle)) -
                                 1.0 / (at.z * std::cos(angle) + (half - at.x) * std::sin(angle)));
        CAPTURE(at.x);
        CAPTURE(at.y);
        test::check_below("in height, pixels", std::abs(in_right - in_left - expected), 1e-5);
    }
    CHECK(glm::distance(left.target, camera.target) == 0.0);
}

TEST_CASE("eyes at no distance are the camera; orthographic ones turn about the target")
{
    Camera camera = looking();
    const auto [left, right] = eyes_of(camera, {.eye_distance = 0.0});
    CHECK(left == camera);
    CHECK(right == camera);
    camera.projection = Camera::Projection::orthographic;
    const auto turned = eyes_of(camera, {.eye_distance = 0.1});
    CHECK(turned.first.target == camera.target);
    CHECK(turned.first.eye != turned.second.eye);
    CHECK(turned.first.shift_right == 0.0);
}

TEST_CASE("a slice's plane goes through the probe, half-way between the clip planes")
{
    const VolumeInfo volume = volume_of_size({40, 30, 50}, {0.5, 0.75, 2.0});
    for (const glm::dvec3 probe : {glm::dvec3(3.5, 4.5, 5.5), glm::dvec3(-5.0, 100.0, 49.9), glm::dvec3(20, 15, 25)})
        for (const double zoom : {1.0, 4.0}) {
            ViewSettings settings = arranged(Arrangement::slices);
            settings.slices.zoom = zoom;
            const std::vector<Pane> panes = panes_of(settings, looking(), {200, 160}, volume, probe);
            REQUIRE(panes.size() == 4);
            for (size_t i = 1; i < 4; ++i) {
                const Camera& camera = panes[i].shot.camera;
                const int axis = panes[i].axis;
                CHECK(panes[i].shot.is_slice);
                CHECK(camera.projection == Camera::Projection::orthographic);
                const double depth = 0.5 * (camera.near_distance + camera.far_distance);
                const glm::dvec3 middle = camera.eye + depth * axes_of(camera).forward;
                const double inside = std::clamp(probe[axis], 0.0, double(volume.size[axis]));
                CHECK(middle[axis] == doctest::Approx(inside * volume.spacing[axis]));
                CHECK(float(middle[axis] / volume.spacing[axis]) < float(volume.size[axis]));
                CHECK(std::abs(axes_of(camera).forward[axis]) == doctest::Approx(1.0));
                if (zoom > 1.0) {
                    const glm::dvec3 seen =
                        glm::clamp(probe, glm::dvec3(0.0), glm::dvec3(volume.size)) * volume.spacing;
                    CHECK(glm::distance(project(camera, {100, 80}, seen)->pixel, glm::dvec2(50, 40)) < 1e-9);
                }
            }
        }
}

TEST_CASE("slices zoom about what is under the mouse, follow it when they are dragged, and go along with the probe")
{
    const VolumeInfo volume = volume_of_size({400, 300, 500}, {0.5, 0.75, 2.0});
    const glm::uvec2 pixels(401, 322);
    const glm::dvec3 probe(150.0, 120.0, 200.0);
    ViewSettings settings = arranged(Arrangement::slices);
    const auto place = [&](size_t pane, const glm::dvec2& pixel, const glm::dvec3& at) {
        const Pane seen = panes_of(settings, looking(), pixels, volume, at)[pane];
        return unproject(seen.shot.camera, seen.pixels(), pixel, 0.0);
    };
    const auto beside = [](glm::dvec3 a, glm::dvec3 b, int axis) {
        a[axis] = b[axis] = 0.0;
        return glm::distance(a, b);
    };
    for (size_t pane = 1; pane < 4; ++pane) {
        CAPTURE(pane);
        settings.slices = {};
        const glm::dvec2 at(104.0, 70.5);  // in the volume
        const int axis = panes_of(settings, looking(), pixels, volume, probe)[pane].axis;
        for (const double factor : {2.0, 3.0, 0.5}) {  // the first from slices that are not enlarged
            const glm::dvec3 held = place(pane, at, probe);
            const Pane seen = panes_of(settings, looking(), pixels, volume, probe)[pane];
            settings.slices = slices_zoomed(settings.slices, seen, at, factor, volume, probe);
            CHECK(beside(place(pane, at, probe), held, axis) < 1e-9);
            // Another place of the probe moves no slice to the side.
            CHECK(beside(place(pane, at, {10.0, 20.0, 30.0}), held, axis) < 1e-9);
        }
        CHECK(settings.slices.zoom == 3.0);
        const glm::dvec3 grabbed = place(pane, at, probe);
        const Pane seen = panes_of(settings, looking(), pixels, volume, probe)[pane];
        settings.slices = slices_moved(settings.slices, seen, {12.0, -7.0}, volume, probe);
        CHECK(beside(place(pane, at + glm::dvec2(12.0, -7.0), probe), grabbed, axis) < 1e-9);
        const Pane moved = panes_of(settings, looking(), pixels, volume, probe)[pane];
        CHECK(slices_zoomed(settings.slices, moved, at, 0.01, volume, probe) == SliceSettings{});  // the whole again
    }

    // A probe that is out of sight is brought into it, along the axes along which it is not seen.
    settings.slices = {};
    settings.slices.zoom = 8.0;
    settings.slices.center = probe;
    const auto followed = [&](const glm::dvec3& at, std::optional<size_t> held) {
        return slices_following(settings.slices, panes_of(settings, looking(), pixels, volume, at), held, volume, at);
    };
    CHECK(followed(probe + 3.0, {}) == settings.slices);
    const glm::dvec3 far(20.0, 121.0, 202.0);
    CHECK(followed(far, {}).center == glm::dvec3(20.0, 120.0, 200.0));
    // Where the mouse leads it in the slice across z, that stays; along z the others follow.
    const Pane across_z = panes_of(settings, looking(), pixels, volume, probe)[1];
    REQUIRE(across_z.axis == 2);
    glm::dvec3 edge = unproject(across_z.shot.camera, across_z.pixels(), {1.0, 1.0}, 0.0) / volume.spacing;
    edge.z = 480.0;
    CHECK(followed(edge, 1).center == glm::dvec3(probe.x, probe.y, 480.0));
    // The slice across y shows more at once: a position outside the one across z is still visible there, so it stays.
    const Pane across_y = panes_of(settings, looking(), pixels, volume, probe)[2];
    REQUIRE(across_y.axis == 1);
    glm::dvec3 wide = unproject(across_y.shot.camera, across_y.pixels(), {60.0, 80.0}, 0.0) / volume.spacing;
    wide.y = probe.y;
    CHECK(followed(wide, 2) == settings.slices);
    CHECK(followed(wide, {}).center->x == wide.x);
    CHECK(followed({20.0, 20.0, 480.0}, 1).center == glm::dvec3(20.0, 20.0, 480.0));  // it is not seen there
}

TEST_CASE("a ball's silhouette is where rays touch it")
{
    const Camera camera = looking();
    const glm::uvec2 pixels(400, 300);
    const glm::dvec3 center(25.0, 12.0, 20.0);
    for (const double radius : {0.5, 10.0, 60.0}) {
        const std::vector<glm::dvec2> outline = silhouette_of(camera, pixels, center, radius);
        REQUIRE(!outline.empty());
        for (const glm::dvec2& pixel : outline) {
            const glm::dvec3 direction = glm::normalize(unproject(camera, pixels, pixel, 1.0) - camera.eye);
            const glm::dvec3 to_center = center - camera.eye;
            const double distance = glm::length(to_center - direction * glm::dot(direction, to_center));
            CHECK(distance == doctest::Approx(radius).epsilon(1e-9));
        }
    }
    CHECK(silhouette_of(camera, pixels, camera.eye, 5.0).empty());
}

TEST_CASE("a probe out of sight has an arrow at the border, towards it")
{
    const VolumeInfo volume = volume_of_size({40, 30, 50});
    const Pane pane = panes_of({}, looking(), {400, 300}, volume, glm::dvec3(0.0))[0];
    OverlayScene scene{.main = looking(), .main_pixels = {400, 300}};
    const CameraAxes axes = axes_of(scene.main);
    const struct {
        glm::dvec3 way;  ///< along right, up, forward
        glm::dvec2 side;
    } cases[] = {{{500, 0, 100}, {1, 0}}, {{-500, 0, 100}, {-1, 0}}, {{0, 500, 100}, {0, -1}}, {{0, -9, -100}, {0, 1}}};
    for (const auto& [way, side] : cases) {
        scene.probe.center = scene.main.eye + way.x * axes.right + way.y * axes.up + way.z * axes.forward;
        const std::vector<Stroke> strokes = strokes_of(pane, scene, volume);
        REQUIRE(strokes.size() == 6);  // a shaft and two barbs, each with its halo
        for (const Stroke& stroke : strokes)
            CHECK((glm::all(glm::lessThan(glm::abs(stroke.to - glm::dvec2(200, 150)), glm::dvec2(200, 150)))));
        const glm::dvec2 shaft = strokes[3].to - strokes[3].from;
        CHECK(glm::dot(glm::normalize(shaft), side) > 0.99);
    }
    scene.probe.center = scene.main.target;
    CHECK(strokes_of(pane, scene, volume).size() > 48);  // in sight: its silhouette
    scene.probe.is_outlined = false;
    CHECK(strokes_of(pane, scene, volume).empty());
}

TEST_CASE("a map shows the outlines of the volume and of the frustum, thin and whole, of one colour each")
{
    const VolumeInfo volume = volume_of_size({40, 30, 50});
    Camera main;
    main.eye = {20.0, -20.0, 26.0};
    main.target = {20.5, 15.0, 25.0};
    main.near_distance = 25.0;
    main.far_distance = 45.0;
    const std::vector<Pane> panes = panes_of(arranged(Arrangement::overview), main, {800, 600}, volume, glm::dvec3(0));
    const OverlayScene scene{.main = main, .main_pixels = {400, 300}, .probe = {.is_outlined = false}};
    for (size_t i = 1; i < 4; ++i) {
        const std::vector<Stroke> strokes = strokes_of(panes[i], scene, volume);
        // Behind the borders to other panes: the volume's four sides, then the frustum, each closed.
        const size_t borders = (panes[i].box.begin.x > 0) + (panes[i].box.begin.y > 0);
        const std::span<const Stroke> lines = std::span(strokes).subspan(strokes.size() / 2 + borders);
        REQUIRE(lines.size() >= 4 + 3);
        CHECK(lines.size() <= 4 + 8);
        const glm::dvec3 extent = glm::dvec3(volume.size) * volume.spacing;
        for (size_t k = 0; k < lines.size(); ++k) {
            CHECK(lines[k].width == 1.0);
            CHECK(strokes[borders + k].width == 2.0);  // its halo
            CHECK(lines[k].color == lines[k < 4 ? 0 : 4].color);
            const size_t next = k == 3 ? 0 : k + 1 == lines.size() ? 4 : k + 1;
            CHECK(glm::distance(lines[k].to, lines[next].from) < 1e-9);
        }
        CHECK(lines[0].color != lines[4].color);
        // The volume's sides are where its corners are.
        const auto corner = project(panes[i].shot.camera, panes[i].pixels(), extent);
        REQUIRE(corner.has_value());
        double nearest = 1e9;
        for (size_t k = 0; k < 4; ++k) nearest = std::min(nearest, glm::distance(lines[k].from, corner->pixel));
        CHECK(nearest < 1e-9);
    }
}

TEST_CASE("a stroke covers the pixels that it is wide, and none outside its pane")
{
    ImageF image{40, 30, std::vector<float>(40 * 30 * 4, 0.0f)};
    const Stroke level{.from = {2.0, 10.5}, .to = {18.0, 10.5}, .color = {1.0, 0.5, 0.25}, .width = 1.0};
    draw_strokes(image, std::span(&level, 1), {{5, 0}, {15, 30}});
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            const float* const pixel = &image.rgba[4 * size_t(x + 40 * y)];
            const double covered = y != 10 || x >= 15 || x < 6 ? 0.0 : x == 6 ? 0.5 : 1.0;  // half of its round end
            CHECK(pixel[0] == doctest::Approx(covered));
            CHECK(pixel[2] == doctest::Approx(0.25 * covered));
            CHECK(pixel[3] == doctest::Approx(covered));
        }
    const Stroke flat{
        .from = {2.0, 5.5}, .to = {4.5, 5.5}, .color = glm::dvec3(1.0), .width = 3.0, .has_flat_ends = true};
    draw_strokes(image, std::span(&flat, 1), {{0, 0}, {40, 30}});
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 10; ++x) {
            const double covered = y < 4 || y > 6 || x < 2 || x > 4 ? 0.0 : x == 4 ? 0.5 : 1.0;
            CHECK(image.rgba[4 * size_t(x + 40 * y)] == doctest::Approx(covered));
        }
    const Stroke between{.from = {1.0, 20.0}, .to = {39.0, 20.0}, .color = glm::dvec3(1.0), .width = 1.0};
    draw_strokes(image, std::span(&between, 1), {{0, 0}, {40, 30}});
    CHECK(image.rgba[4 * size_t(20 + 40 * 19)] == doctest::Approx(0.5));
    CHECK(image.rgba[4 * size_t(20 + 40 * 20)] == doctest::Approx(0.5));
}
