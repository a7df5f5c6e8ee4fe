// Handles of the oblique cutting plane: where they are, and where a drag puts the plane.

#include "engine/workbench/sight/plane_handles.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/unit/ui/sight/slanted_pane.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

Pane slice_across_z()
{
    Camera camera;
    camera.projection = Camera::Projection::orthographic;
    camera.eye = {50.0, 80.0, 15.0 + 100.0};
    camera.target = {50.0, 80.0, 15.0};
    camera.up = {0.0, 1.0, 0.0};
    camera.height = 240.0;
    camera.near_distance = 99.0;
    camera.far_distance = 101.0;
    Pane pane = pane_of(camera);
    pane.kind = Pane::Kind::slice;
    pane.axis = 2;
    return pane;
}

CutBox oblique()
{
    CutBox cut;
    cut.plane_normal = glm::dvec3(3.0, -1.0, 2.0);
    cut.plane_point = glm::dvec3(48.0, 37.0, 33.0);
    return cut;
}

/// The distance of a pixel's point of the slice beyond the plane.
double beyond(const CutBox& cut, const Pane& pane, const glm::dvec2& pixel)
{
    const glm::dvec3 point = unproject(pane.shot.camera, pane.pixels(), pixel, 100.0);
    return glm::dot(plane_in_voxels(cut, volume().size, volume().spacing), glm::dvec4(point / volume().spacing, 1.0));
}

}  // namespace

TEST_CASE("the dragged handles of a plane stay under the pointer, and each changes only what it is for")
{
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        const Pane pane = pane_of(slanted(projection));
        const auto handles = [&](const CutBox& cut) { return plane_handles(pane, cut, volume()); };
        const CutBox cut = oblique();
        REQUIRE(handles(cut).size() == 2);
        const PlaneHandle move = handles(cut)[0], tilt = handles(cut)[1];
        CHECK(move.kind == PlaneHandle::Kind::move);
        CHECK(tilt.kind == PlaneHandle::Kind::tilt);
        CHECK(handle_at(handles(cut), tilt.at + glm::dvec2(1.0, 0.0)) == tilt);
        CHECK(!handle_at(handles(cut), glm::max(move.at, tilt.at) + 11.0));
        // Five units along the normal, in physical space.
        const glm::dvec3 normal = glm::normalize(*cut.plane_normal);
        const glm::dvec3 wanted = *cut.plane_point * volume().spacing + 5.0 * normal;
        const CutBox moved =
            dragged(cut, move, pane, volume(), move.at, project(pane.shot.camera, pane.pixels(), wanted)->pixel);
        CHECK(glm::distance(*moved.plane_point * volume().spacing, wanted) < 1e-6);
        CHECK(*moved.plane_normal == *cut.plane_normal);
        // The tip follows, and the point at its foot remains on the plane.
        const glm::dvec2 to = tilt.at + glm::dvec2(-25.0, 17.0);
        const CutBox tilted = dragged(cut, tilt, pane, volume(), tilt.at, to);
        CHECK(glm::distance(handles(tilted)[1].at, to) < 1e-6);
        CHECK(tilted.plane_point == cut.plane_point);
        CHECK(glm::length(*tilted.plane_normal) == doctest::Approx(1.0));
        // However far the pointer goes.
        const glm::dvec3 flat = *dragged(cut, tilt, pane, volume(), tilt.at, {3000.0, -2000.0}).plane_normal;
        CHECK(glm::length(flat) == doctest::Approx(1.0));
    }
}

TEST_CASE("a plane is not moved off the volume")
{
    const Pane pane = pane_of(slanted(Camera::Projection::orthographic));
    const PlaneHandle move = plane_handles(pane, oblique(), volume())[0];
    for (const glm::dvec2 to : {glm::dvec2(5000.0, -4000.0), glm::dvec2(-5000.0, 4000.0)}) {
        const CutBox cut = dragged(oblique(), move, pane, volume(), move.at, to);
        const glm::dvec4 plane = plane_in_voxels(cut, volume().size, volume().spacing);
        double least = 1e300, most = -1e300;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 at = glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2) * glm::dvec3(volume().size);
            least = std::min(least, glm::dot(plane, glm::dvec4(at, 1.0)));
            most = std::max(most, glm::dot(plane, glm::dvec4(at, 1.0)));
        }
        CHECK(std::min(std::abs(least), std::abs(most)) < 1e-6);  // touches a corner
    }
}

TEST_CASE("a plane that faces the viewer is pushed away by a drag upwards")
{
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        const Pane pane = pane_of(slanted(projection));
        const Camera& camera = pane.shot.camera;
        const CutBox facing = cut_facing(CutBox{}, camera, volume());
        const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
        CHECK(glm::distance(*facing.plane_normal, -forward) < 1e-12);
        CHECK(*facing.plane_point == camera.target / volume().spacing);
        CutBox flipped = facing;
        flipped.plane_normal = forward;
        for (const CutBox& cut : {facing, flipped}) {
            const std::vector<PlaneHandle> handles = plane_handles(pane, cut, volume());
            REQUIRE(handles.size() == 2);
            CHECK(glm::distance(handles[0].at, handles[1].at) > 30.0);  // not one over the other
            const CutBox away =
                dragged(cut, handles[0], pane, volume(), handles[0].at, handles[0].at - glm::dvec2(0.0, 8.0));
            const double way = glm::dot((*away.plane_point - *cut.plane_point) * volume().spacing, forward);
            const double unit = pixel_size(camera, pane.pixels(), glm::distance(camera.eye, camera.target));
            CHECK(way == doctest::Approx(8.0 * unit));
        }
    }
    // What is looked at is cut away: the middle of the box.
    const CutBox corner{{60.0, 20.0, 30.0}, {90.0, 40.0, 50.0}};
    const CutBox cut = cut_facing(corner, slanted(Camera::Projection::orthographic), volume());
    CHECK(*cut.plane_point == glm::dvec3(75.0, 30.0, 40.0));
    CHECK(cut.lower == corner.lower);
}

TEST_CASE("in a slice the plane's line follows the pointer, and its angle with the slice remains")
{
    const Pane pane = slice_across_z();
    const CutBox cut = oblique();
    const std::vector<PaneLine> lines = plane_lines(pane, cut, volume());
    REQUIRE(lines.size() == 2);
    // The first is where the plane crosses the slice, from one border of the volume to another.
    for (const glm::dvec2& end : {lines[0].first, lines[0].second}) {
        CHECK(std::abs(beyond(cut, pane, end)) < 1e-6);
        const glm::dvec3 voxel = unproject(pane.shot.camera, pane.pixels(), end, 100.0) / volume().spacing;
        const glm::dvec3 size(volume().size);
        CHECK(std::min({std::abs(voxel.x), std::abs(voxel.x - size.x), std::abs(voxel.y), std::abs(voxel.y - size.y)}) <
              1e-6);
    }
    const std::vector<PlaneHandle> handles = plane_handles(pane, cut, volume());
    REQUIRE(handles.size() == 2);
    CHECK(std::abs(beyond(cut, pane, handles[0].at)) < 1e-6);
    CHECK(beyond(cut, pane, handles[1].at) > 1.0);  // the normal points to what is removed
    const glm::dvec2 to = handles[0].at + glm::dvec2(9.0, -6.0);
    const CutBox moved = dragged(cut, handles[0], pane, volume(), handles[0].at, to);
    CHECK(std::abs(beyond(moved, pane, to)) < 1e-6);
    CHECK(*moved.plane_normal == *cut.plane_normal);
    const CutBox tilted =
        dragged(cut, handles[1], pane, volume(), handles[1].at, handles[1].at + glm::dvec2(-40.0, -35.0));
    CHECK(std::abs(beyond(tilted, pane, handles[0].at)) < 1e-6);
    CHECK(tilted.plane_normal->z == doctest::Approx(glm::normalize(*cut.plane_normal).z));
    const glm::dvec2 before = handles[1].at - handles[0].at, wanted = before + glm::dvec2(-40.0, -35.0);
    const glm::dvec2 is(tilted.plane_normal->x, -tilted.plane_normal->y);  // rows go down
    CHECK(glm::dot(glm::normalize(is), glm::normalize(wanted)) == doctest::Approx(1.0));
}

TEST_CASE("no handles where there is no plane, in maps, and in slices that the plane does not cross")
{
    CHECK(plane_handles(slice_across_z(), CutBox{}, volume()).empty());
    CHECK(plane_lines(slice_across_z(), CutBox{}, volume()).empty());
    Pane map = pane_of(slanted(Camera::Projection::orthographic));
    map.kind = Pane::Kind::map;
    CHECK(plane_handles(map, oblique(), volume()).empty());
    CutBox parallel = oblique();
    parallel.plane_normal = glm::dvec3(0.0, 0.0, 1.0);
    CHECK(plane_handles(slice_across_z(), parallel, volume()).empty());
    CHECK(plane_lines(slice_across_z(), parallel, volume()).empty());
    CutBox elsewhere = oblique();
    elsewhere.plane_normal = glm::dvec3(1.0, 0.0, 0.1);
    elsewhere.plane_point = glm::dvec3(130.0, 40.0, 30.0);
    CHECK(plane_handles(slice_across_z(), elsewhere, volume()).empty());
}

TEST_CASE("lines in the volume go around the section of the uncut box, all on the plane")
{
    const Pane pane = pane_of(slanted(Camera::Projection::orthographic));
    CutBox cut = oblique();
    cut.lower = {10.0, 5.0, 0.0};
    const std::vector<PaneLine> lines = plane_lines(pane, cut, volume());
    REQUIRE(lines.size() >= 4);
    const size_t sides = lines.size() - 1;  // and the normal
    double turn = 0.0;
    for (size_t i = 0; i < sides; ++i) {
        CHECK(lines[i].second == lines[(i + 1) % sides].first);
        const glm::dvec2 a = lines[i].second - lines[i].first;
        const glm::dvec2 b = lines[(i + 1) % sides].second - lines[(i + 1) % sides].first;
        const double sine = a.x * b.y - a.y * b.x;
        turn = turn == 0.0 ? sine : turn;
        CHECK(sine * turn > 0.0);  // convex
    }
}
