// Handles of the clip box: where they are, and where a drag puts the face.

#include "engine/workbench/sight/cut_handles.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/unit/ui/sight/slanted_pane.h"

using namespace shvr;
using namespace shvr::ui;

TEST_CASE("a dragged face stays under the pointer, whatever the camera and the spacing")
{
    const CutBox cut{{10.0, 20.0, 5.0}, {1e6, 70.0, 50.0}};
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        const Pane pane = pane_of(slanted(projection));
        const std::vector<CutHandle> handles = cut_handles(pane, cut, volume());
        REQUIRE(handles.size() == 6);
        for (const CutHandle& handle : handles) {
            CAPTURE(handle.axis);
            CAPTURE(handle.upper);
            CHECK(handle_at(handles, handle.at + glm::dvec2(1.0, 0.0)) == handle);
            // Towards the middle of the box by four voxels.
            glm::dvec3 wanted = handle.middle / volume().spacing;
            wanted[handle.axis] += handle.upper ? -4.0 : 4.0;
            const glm::dvec2 to = project(pane.shot.camera, pane.pixels(), wanted * volume().spacing)->pixel;
            const CutBox moved = dragged(cut, handle, pane, volume(), handle.at, to);
            CHECK((handle.upper ? moved.upper : moved.lower)[handle.axis] == doctest::Approx(wanted[handle.axis]));
            CutBox back = moved;
            (handle.upper ? back.upper : back.lower)[handle.axis] = (handle.upper ? cut.upper : cut.lower)[handle.axis];
            CHECK(back == cut);
        }
    }
}

TEST_CASE("a face that is seen end on has no handle, nor have maps, and no face passes the other or the volume's end")
{
    Camera camera = slanted(Camera::Projection::orthographic);
    camera.eye = {50.0, 80.0, 400.0};
    camera.up = {0.0, 1.0, 0.0};
    Pane pane = pane_of(camera);
    const CutBox cut{{10.0, 20.0, 5.0}, {90.0, 70.0, 50.0}};
    const std::vector<CutHandle> handles = cut_handles(pane, cut, volume());
    CHECK(handles.size() == 4);
    CHECK(std::ranges::none_of(handles, [](const CutHandle& each) { return each.axis == 2; }));
    const auto far_x =
        std::ranges::find_if(handles, [](const CutHandle& each) { return each.axis == 0 && each.upper; });
    REQUIRE(far_x != handles.end());
    const auto end_at = [&](double x) {
        return dragged(cut, *far_x, pane, volume(), far_x->at, far_x->at + glm::dvec2(x, 0.0)).upper.x;
    };
    CHECK(end_at(1000.0) == 100.0);
    CHECK(end_at(-1000.0) == 11.0);
    CHECK(!handle_at(handles, far_x->at + glm::dvec2(0.0, HANDLE_PIXELS + 0.1)));
    pane.kind = Pane::Kind::map;
    CHECK(cut_handles(pane, cut, volume()).empty());
}

TEST_CASE("a box without thickness can be opened again by the handle that has room")
{
    const Pane pane = pane_of(slanted(Camera::Projection::orthographic));
    for (const double at : {0.0, 1.0, 99.0, 100.0}) {
        CAPTURE(at);
        const CutBox cut{{at, 20.0, 5.0}, {at, 70.0, 50.0}};
        const std::vector<CutHandle> handles = cut_handles(pane, cut, volume());
        REQUIRE(handles.size() == 5);
        CHECK(handles[0].upper == (at < 50.0));
        const double wanted = at < 50.0 ? 40.0 : 60.0;
        const glm::dvec3 middle = handles[0].middle / volume().spacing;
        const glm::dvec2 to =
            project(pane.shot.camera, pane.pixels(), glm::dvec3(wanted, middle.y, middle.z) * volume().spacing)->pixel;
        const CutBox moved = dragged(cut, handles[0], pane, volume(), handles[0].at, to);
        CHECK((at < 50.0 ? moved.upper : moved.lower).x == doctest::Approx(wanted));
    }
}

TEST_CASE("a slice shows the box as a rectangle")
{
    Camera camera = slanted(Camera::Projection::orthographic);
    camera.eye = {50.0, 80.0, 400.0};
    camera.target = {50.0, 80.0, 15.0};
    camera.up = {0.0, 1.0, 0.0};
    camera.height = 480.0;
    Pane pane = pane_of(camera);
    pane.kind = Pane::Kind::slice;
    pane.axis = 2;
    const std::vector<glm::dvec2> corners = box_in_slice(pane, {{10.0, 20.0, 5.0}, {90.0, 70.0, 50.0}}, volume());
    REQUIRE(corners.size() == 4);
    const auto is_corner = [&](double x, double y) {
        const glm::dvec2 pixel(320.0 + x - 50.0, 240.0 - (2.0 * y - 80.0));
        return std::ranges::any_of(corners, [&](const auto& each) { return glm::distance(each, pixel) < 1e-6; });
    };
    CHECK(is_corner(10.0, 20.0));
    CHECK(is_corner(90.0, 20.0));
    CHECK(is_corner(10.0, 70.0));
    CHECK(is_corner(90.0, 70.0));
}
