#include "engine/movie/look_between.h"

#include <doctest/doctest.h>

using namespace shvr;

namespace {

constexpr glm::dvec3 RED{1, 0, 0}, BLUE{0, 0, 1};

TransferFunction window(double lower, double upper, const glm::dvec3& color, double opacity)
{
    return TransferFunction({{lower, color, 0.0}, {upper, color, opacity}});
}

VolumeInfo volume_of(const glm::i64vec3& size)
{
    VolumeInfo volume;
    volume.size = size;
    return volume;
}

}  // namespace

TEST_CASE("the ends of a look's way are exactly the two looks")
{
    Session from, to;
    from.transfer_function = window(0.1, 0.7, RED, 0.3);
    to.transfer_function = TransferFunction({{1.0 / 3.0, BLUE, 0.1}, {0.5, RED, 0.2}, {0.9, RED, 0.7}});
    to.groups[3].visible = false;
    to.light.ambient = 0.1;
    to.blend.size = 0.4;
    to.cut.upper = {5, 6, 7};
    to.unpainted.opacity = 0.25;
    const VolumeInfo volume = volume_of({10, 10, 10});
    CHECK(session_between(from, to, 0.0, volume) == from);
    CHECK(session_between(from, to, 1.0, volume) == to);
    CHECK(session_between(to, to, 0.7, volume) == to);
}

TEST_CASE("points of functions with equally many points move")
{
    const TransferFunction middle = function_between(window(0, 100, RED, 0.2), window(100, 300, BLUE, 0.6), 0.5);
    REQUIRE(middle.points().size() == 2);
    CHECK(middle.points()[0].intensity == 50.0);
    CHECK(middle.points()[1].intensity == 200.0);
    CHECK(middle.points()[1].opacity == doctest::Approx(0.4));
    CHECK(glm::distance(middle.points()[1].color, glm::dvec3(0.5, 0, 0.5)) < 1e-12);
}

TEST_CASE("functions with different numbers of points fade into each other at every intensity")
{
    // The first ends at 100 with a step; the second has a step at 150 and begins at 50.
    const TransferFunction from = window(0, 100, RED, 0.8);
    const TransferFunction to({{50, BLUE, 0.2}, {150, BLUE, 0.4}, {150, BLUE, 0.1}, {200, BLUE, 0.1}});
    const TransferFunction middle = function_between(from, to, 0.25);
    for (double intensity = -10.0; intensity < 210.0; intensity += 2.5) {
        const glm::dvec4 a = from.at(intensity), b = to.at(intensity), is = middle.at(intensity);
        CAPTURE(intensity);
        CHECK(is.a == doctest::Approx(0.75 * a.a + 0.25 * b.a));
    }
    // Both at their own ends.
    CHECK(middle.at(100.0).a == doctest::Approx(0.75 * 0.8 + 0.25 * to.at(100.0).a));
    CHECK(middle.at(100.001).a == doctest::Approx(0.25 * to.at(100.001).a));
    // Where only one is visible, its colour is.
    CHECK(glm::distance(glm::dvec3(middle.at(180.0)), BLUE) < 1e-9);
    CHECK(glm::distance(glm::dvec3(middle.at(40.0)), RED) < 1e-9);
}

TEST_CASE("opacities of 1 stay 1")
{
    const TransferFunction from = window(0, 1, RED, 1.0), to = window(3, 7, BLUE, 1.0);
    for (int i = 0; i <= 1000; ++i) CHECK(function_between(from, to, i / 1000.0).points()[1].opacity == 1.0);
}

TEST_CASE("cuts move from the volume's border")
{
    CutBox cut;
    cut.lower = {2, 0, 0};
    cut.upper = {10, 4, 10};
    const CutBox middle = cut_between(CutBox{}, cut, 0.5, volume_of({10, 10, 10}));
    CHECK(middle.lower == glm::dvec3(1, 0, 0));
    CHECK(middle.upper == glm::dvec3(10, 7, 10));
    // A plane comes from where it cuts nothing, and two turn into each other.
    CutBox plane;
    plane.plane_normal = glm::dvec3(2, 0, 0);
    plane.plane_point = glm::dvec3(4, 5, 5);
    const CutBox coming = cut_between(CutBox{}, plane, 0.5, volume_of({10, 10, 10}));
    CHECK(*coming.plane_normal == glm::dvec3(1, 0, 0));
    CHECK(coming.plane_point->x == 7.0);
    CHECK(cut_between(plane, CutBox{}, 0.5, volume_of({10, 10, 10})).plane_point->x == 7.0);
    CHECK(!cut_between(plane, CutBox{}, 1.0, volume_of({10, 10, 10})).plane_normal);
    CutBox turned = plane;
    turned.plane_normal = glm::dvec3(0, 3, 0);
    CHECK(*cut_between(plane, turned, 0.5, volume_of({10, 10, 10})).plane_normal == glm::dvec3(0.5, 0.5, 0));
    turned.plane_normal = glm::dvec3(-1, 0, 0);
    CHECK(glm::length(*cut_between(plane, turned, 0.5, volume_of({10, 10, 10})).plane_normal) > 0.5);
}

TEST_CASE("hidden groups fade, and what they inherit counts")
{
    Groups from, to;
    from[1] = {.color = RED, .opacity = 0.8};
    from[2] = {.parent = 1};
    to = from;
    to[1].visible = false;
    const Groups middle = groups_between(from, to, 0.25);
    for (const uint8_t group : {uint8_t(1), uint8_t(2)}) {
        const ColorGroup look = group_of(middle, group);
        CHECK(look.visible);
        CHECK(look.opacity == doctest::Approx(0.6));
        CHECK(look.color == RED);
    }
    CHECK(parent_of(middle, 2) == 1);
    to[2].parent = 0;
    CHECK(parent_of(groups_between(from, to, 0.25), 2) == 0);
    CHECK(group_of(groups_between(from, to, 0.25), 2).visible);
}

TEST_CASE("light turns from where it comes by default, and blending keeps the colour of the view that has one")
{
    Light from, to;
    to.direction = {0.3, -0.5, 1.0};
    to.diffuse = 0.1;
    const Light middle = light_between(from, to, 0.5);
    CHECK(middle.direction.y == doctest::Approx(0.0));
    CHECK(middle.direction.z > 0.0);
    CHECK(middle.diffuse == doctest::Approx(0.4));
    to.direction = {-0.3, -0.5, -1.0};
    CHECK(light_between(from, to, 0.5).direction == from.direction);

    Session plain, blended;
    blended.blend = {.size = 0.8, .rate = 2.0, .color = BLUE};
    for (const Session* first : {&plain, &blended}) {
        const Session& second = first == &plain ? blended : plain;
        const DistanceBlend blend = session_between(*first, second, 0.5, volume_of({9, 9, 9})).blend;
        CHECK(blend.size == doctest::Approx(0.4));
        CHECK(blend.rate == 2.0);
        CHECK(blend.color == BLUE);
    }
}

TEST_CASE("unpainted voxels that are hidden in one view fade")
{
    Session from, to;
    to.unpainted = {.visible = false, .opacity = 0.5};
    const Unpainted middle = session_between(from, to, 0.25, volume_of({9, 9, 9})).unpainted;
    CHECK(middle.visible);
    CHECK(middle.opacity == doctest::Approx(0.75));
}
