// Lines over pictures: the box that the cutting planes leave, and what of the probe's lines is switched off.

#include "engine/look/overlay.h"

#include <doctest/doctest.h>

using namespace shvr;

namespace {

VolumeInfo volume()
{
    VolumeInfo volume;
    volume.size = Size3(40, 40, 40);
    volume.spacing = {0.5, 0.5, 2.0};
    return volume;
}

/// From the front, far enough to see all of the volume.
Pane front()
{
    Camera camera;
    camera.eye = {10, -300, 40};
    camera.target = {10, 10, 40};
    camera.up = {0, 0, 1};
    camera.fov_y_degrees = 30.0;
    return {.kind = Pane::Kind::main, .shot = camera, .box = {glm::uvec2(0), {200, 200}}, .name = "", .axis = -1};
}

OverlayScene without_probe()
{
    return {
        .main = front().shot.camera, .main_pixels = {200, 200}, .probe = {.is_outlined = false, .has_arrow = false}};
}

/// Each stroke has a halo below it.
size_t lines(const Pane& pane, const OverlayScene& scene)
{
    return strokes_of(pane, scene, volume()).size() / 2;
}

}  // namespace

TEST_CASE("the box of the cutting planes is in physical units, and ends where the volume does")
{
    const OverlayScene::Box whole = box_of({}, volume());
    CHECK(whole.lower == glm::dvec3(0.0));
    CHECK(whole.upper == glm::dvec3(20, 20, 80));
    const OverlayScene::Box cut = box_of({.lower = {4, 0, 10}, .upper = {12, 40, 1e6}}, volume());
    CHECK(cut.lower == glm::dvec3(2, 0, 20));
    CHECK(cut.upper == glm::dvec3(6, 20, 80));
}

TEST_CASE("of a box the edges of faces that look at the viewer are solid, those behind stippled")
{
    OverlayScene scene = without_probe();
    CHECK(lines(front(), scene) == 0);
    scene.box = box_of({}, volume());
    const std::vector<Stroke> strokes = strokes_of(front(), scene, volume());
    size_t long_ones = 0, short_ones = 0;
    for (size_t i = strokes.size() / 2; i < strokes.size(); ++i) {
        const double length = glm::distance(strokes[i].from, strokes[i].to);
        length > 5.5 ? ++long_ones : ++short_ones;
    }
    // The front face looks at the viewer, no other: its four edges, and none of those that lead away.
    CHECK(long_ones == 4);
    CHECK(short_ones > 20);
}

TEST_CASE("a box around the eye is drawn as far as it lies before it, and in slices not at all")
{
    OverlayScene scene = without_probe();
    Pane inside = front();
    inside.shot.camera.eye = {10, 5, 40};
    inside.shot.camera.fov_y_degrees = 150.0;
    scene.box = box_of({}, volume());
    const std::vector<Stroke> strokes = strokes_of(inside, scene, volume());
    CHECK(!strokes.empty());
    for (const Stroke& stroke : strokes)
        for (const glm::dvec2& end : {stroke.from, stroke.to})
            CHECK(glm::all(glm::lessThan(glm::abs(end), glm::dvec2(1000.0))));
    Pane slice = front();
    slice.kind = Pane::Kind::slice;
    slice.shot.is_slice = true;
    const size_t with_box = lines(slice, scene);
    scene.box.reset();
    CHECK(lines(slice, scene) == with_box);
}

TEST_CASE("silhouette and arrow of the probe are switched off each by itself")
{
    OverlayScene scene = without_probe();
    for (const bool is_in_sight : {true, false}) {
        CAPTURE(is_in_sight);
        scene.probe = {.center = is_in_sight ? glm::dvec3(10, 10, 40) : glm::dvec3(500, 10, 40), .radius = 3.0};
        CHECK(lines(front(), scene) > 0);
        scene.probe.is_outlined = false;
        CHECK((lines(front(), scene) > 0) == !is_in_sight);
        scene.probe.is_outlined = true;
        scene.probe.has_arrow = false;
        CHECK((lines(front(), scene) > 0) == is_in_sight);
    }
}
