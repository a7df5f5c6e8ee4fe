// Outlines drawn over panes, as cuts that no longer depend on the pane.

#include "engine/workbench/sight/outlines.h"

#include <random>

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

VolumeInfo volume_of(const glm::dvec3& spacing)
{
    VolumeInfo volume;
    volume.size = {100, 80, 60};
    volume.spacing = spacing;
    volume.unit = "mm";
    return volume;
}

/// The pixel that shows the point of the outline's plane, at this distance from the eye of the cut.
glm::dvec2 pixel_of(const LassoOp& op, const Pane& pane, const glm::dvec2& point, double depth)
{
    const LassoAxes axes = axes_of(op.view);
    const bool is_perspective = op.view.projection == LassoView::Projection::perspective;
    const glm::dvec2 away = is_perspective ? point * depth : point;
    const glm::dvec3 at = op.view.eye + axes.forward * depth + axes.right * away.x + axes.up * away.y;
    return project(pane.shot.camera, pane.pixels(), at).value().pixel;
}

}  // namespace

TEST_CASE("an outline covers in a cut's view the pixels that it covers in its pane, whatever the camera")
{
    std::mt19937 random(61);
    const auto between = [&](double lower, double upper) {
        return lower + (upper - lower) * double(random() % 1'000'001) / 1'000'000.0;
    };
    for (int i = 0; i < 40; ++i) {
        CAPTURE(i);
        const VolumeInfo volume = volume_of({between(0.1, 2.0), between(0.1, 2.0), between(0.1, 2.0)});
        ViewSettings view;
        view.arrangement = i % 2 == 0 ? Arrangement::slices : Arrangement::stereo;
        view.slices.zoom = between(1.0, 4.0);
        Camera camera = camera_of(
            SideView{.side = "front", .zoom = 1.0, .turn_degrees = between(0, 360), .tilt_degrees = between(-80, 80)},
            volume);
        camera.projection = i % 3 == 0 ? Camera::Projection::orthographic : Camera::Projection::perspective;
        const std::vector<Pane> panes = panes_of(view, camera, {640, 480}, volume, {40, 30, 20});
        REQUIRE(panes.size() > 1);
        for (const Pane& pane : panes) {
            const std::vector<glm::dvec2> drawn{{12.5, 20}, {100, 31.25}, {80, 77}};
            LassoOp op;
            set_outline(op, pane, drawn, std::nullopt, CutBox{}, volume);
            REQUIRE(axes_of(op.view).is_valid);
            CHECK(!op.depth);
            for (size_t point = 0; point < drawn.size(); ++point)
                for (const double depth : {0.01, 1.0, 300.0})
                    CHECK(glm::distance(pixel_of(op, pane, op.polygon[point], depth), drawn[point]) < 1e-6);
        }
    }
}

TEST_CASE("a depth is counted from where the visible part begins, and to both sides of a slice")
{
    const VolumeInfo volume = volume_of({0.5, 1.0, 2.0});
    ViewSettings view;
    view.arrangement = Arrangement::slices;
    const Camera camera = camera_looking("front", volume);  // along +y
    const std::vector<Pane> panes = panes_of(view, camera, {640, 480}, volume, {40.25, 30.5, 20.75});
    const CutBox cut{{0, 25, 0}, {1e6, 1e6, 1e6}};
    LassoOp op;
    const std::vector<glm::dvec2> drawn = rectangle_of({1, 2}, {30, 40});
    CHECK((drawn == std::vector<glm::dvec2>{{1, 2}, {30, 2}, {30, 40}, {1, 40}}));
    set_outline(op, panes[0], drawn, 7.0, cut, volume);
    CHECK(op.depth->x == doctest::Approx(25.0 - camera.eye.y));
    CHECK(op.depth->y == doctest::Approx(25.0 - camera.eye.y + 7.0));
    CutBox oblique;  // leaves y >= x + 30, in physical units
    oblique.plane_normal = glm::dvec3(1.0, -1.0, 0.0);
    oblique.plane_point = glm::dvec3(20.0, 40.0, 0.0);
    set_outline(op, panes[0], drawn, 7.0, oblique, volume);
    CHECK(op.depth->x == doctest::Approx(30.0 - camera.eye.y));
    for (size_t i = 1; i < panes.size(); ++i) {
        set_outline(op, panes[i], drawn, 7.0, cut, volume);
        CHECK((op.depth == glm::dvec2(-3.5, 3.5)));
        const int axis = panes[i].axis;
        CHECK(op.view.eye[axis] == doctest::Approx(glm::dvec3(40.25, 30.5, 20.75)[axis] * volume.spacing[axis]));
    }
}
