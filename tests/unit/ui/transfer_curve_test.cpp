// Editing the transfer function without a window: positions, hits under the mouse, and the resulting points.

#include "engine/workbench/curves/transfer_curve.h"

#include <cfloat>

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

using Grip = TransferCurve::Grip;
using Found = TransferCurve::Found;

const glm::dvec3 RED(1, 0, 0), BLUE(0, 0, 1);
/// 100 pixels wide and high, from intensity 0 to 200.
const CurveAxes AXES{.begin = {10.0f, 20.0f}, .end = {110.0f, 120.0f}, .lower = 0.0, .upper = 200.0};
const TransferCurve::Reach REACH{.pixels = 9.0f, .label = 17.0f};

TransferCurve ramp()
{
    return TransferCurve(TransferFunction({{50.0, RED, 0.0}, {150.0, BLUE, 1.0}}));
}

}  // namespace

TEST_CASE("pixels and values of the curve are two names of one place")
{
    CHECK(AXES.x_of(0.0) == 10.0f);
    CHECK(AXES.x_of(200.0) == 110.0f);
    CHECK(AXES.y_of(0.25) == 70.0f);  // the square root of the opacity
    for (const double intensity : {0.0, 12.5, 50.0, 200.0}) CHECK(AXES.intensity_at(AXES.x_of(intensity)) == intensity);
    for (const double opacity : {0.0, 0.0625, 0.25, 1.0}) CHECK(AXES.opacity_at(AXES.y_of(opacity)) == opacity);
    CHECK(AXES.intensity_at(-1000.0f) == 0.0);
    CHECK(AXES.opacity_at(-1000.0f) == 1.0);
    const CurveRange wide = range_of_curve(TransferFunction({{-5.0, RED, 0.0}, {150.0, BLUE, 1.0}}), 0.0, 100.0);
    CHECK(wide.lower == -5.0);
    CHECK(wide.upper == 150.0);
    CHECK(range_of_curve({}, 3.0, 100.0).lower == 3.0);
    CHECK(range_of_curve({}, 7.0, 7.0).upper == 14.0);  // a volume of one value
}

TEST_CASE("the mouse grabs the nearest point, and lines where no point is near")
{
    const TransferCurve curve = ramp();
    const glm::vec2 first = AXES.place_of(curve.points()[0]);
    CHECK(curve.under(AXES, first + glm::vec2(5, -5), {}, REACH) == Found{Grip::point, 0});
    CHECK(curve.under(AXES, {60.0f, 60.0f}, {190.0, 180.0}, REACH).grip == Grip::nothing);
    CHECK(curve.under(AXES, {106.0f, 60.0f}, {190.0, 180.0}, REACH).grip == Grip::paint_threshold);
    CHECK(curve.under(AXES, {99.0f, 60.0f}, {190.0, 180.0}, REACH).grip == Grip::haptic_threshold);
    // Points go before lines.
    CHECK(curve.under(AXES, first, {50.0, 50.0}, REACH).grip == Grip::point);
    // If two lines coincide, the one whose label is hit is grabbed.
    CHECK(curve.under(AXES, {105.0f, 25.0f}, {190.0, 190.0}, REACH).grip == Grip::paint_threshold);
    CHECK(curve.under(AXES, {105.0f, 45.0f}, {190.0, 190.0}, REACH).grip == Grip::haptic_threshold);
    // A word is grabbed as its line is, wherever it reaches in its own row.
    const TransferCurve::Lines words{190.0, 180.0, {108.0f, 130.0f}, {70.0f, 96.0f}};
    CHECK(curve.under(AXES, {129.0f, 25.0f}, words, REACH).grip == Grip::paint_threshold);
    CHECK(curve.under(AXES, {131.0f, 25.0f}, words, REACH).grip == Grip::nothing);
    CHECK(curve.under(AXES, {129.0f, 45.0f}, words, REACH).grip == Grip::nothing);
    CHECK(curve.under(AXES, {71.0f, 45.0f}, words, REACH).grip == Grip::haptic_threshold);
    CHECK(curve.under(AXES, {71.0f, 25.0f}, words, REACH).grip == Grip::nothing);
    // Below the words it is what a stroke goes by.
    CHECK(curve.under(AXES, {105.0f, 60.0f}, {190.0, 190.0}, REACH).grip == Grip::paint_threshold);
}

TEST_CASE("an added point has the colour that the function has there, or its end's")
{
    TransferCurve curve = ramp();
    CHECK(curve.add(100.0, 0.1) == 1);
    CHECK(curve.points()[1] == ControlPoint{100.0, glm::dvec3(0.5, 0, 0.5), 0.1});
    CHECK(curve.add(10.0, 0.2) == 0);
    CHECK(curve.points()[0].color == RED);
    CHECK(curve.add(180.0, 0.3) == 4);
    CHECK(curve.points()[4].color == BLUE);
    TransferCurve none{TransferFunction()};
    CHECK(none.add(1.0, 0.5) == 0);
}

TEST_CASE("two points are never removed, and the selection stays on the curve")
{
    TransferCurve curve = ramp();
    CHECK(curve.remove(1) == 1);
    CHECK(curve.points().size() == 2);
    curve.add(100.0, 0.1);
    CHECK(curve.remove(2) == 1);
    CHECK(curve.points().size() == 2);
    CHECK(curve.points()[1].intensity == 100.0);
}

TEST_CASE("a point that is moved stays between its neighbours")
{
    TransferCurve curve = ramp();
    curve.add(100.0, 0.1);
    curve.move(1, 500.0, 0.4);
    CHECK(curve.points()[1].intensity == 150.0);
    CHECK(curve.points()[1].opacity == 0.4);
    curve.move(1, -500.0, 2.0);
    CHECK(curve.points()[1].intensity == 50.0);
    CHECK(curve.function().points()[1].opacity == 1.0);  // what a transfer function takes
    CHECK(curve.held_between_neighbors(0, -DBL_MAX) == -double(FLT_MAX));
}

TEST_CASE("all points are shifted, and part of the function stays within the volume's intensities")
{
    TransferCurve curve = ramp();
    CHECK(curve.shift_all(10.0, 0.0, 200.0) == 10.0);
    CHECK(curve.points()[0].intensity == 60.0);
    CHECK(curve.points()[1].intensity == 160.0);
    CHECK(curve.shift_all(1000.0, 0.0, 200.0) == 140.0);
    CHECK(curve.points()[0].intensity == 200.0);
    CHECK(curve.shift_all(-1000.0, 0.0, 200.0) == -300.0);
    CHECK(curve.points()[1].intensity == 0.0);
    CHECK(curve.points()[1].opacity == 1.0);
    // A function that lies outside already may come back.
    TransferCurve outside(TransferFunction({{500.0, RED, 0.0}, {600.0, BLUE, 1.0}}));
    CHECK(outside.shift_all(50.0, 0.0, 200.0) == 0.0);
    CHECK(outside.shift_all(-50.0, 0.0, 200.0) == -50.0);
}

TEST_CASE(
    "a notch of the wheel is a hundredth of what is shown, with the modifier a thousandth, and whole where voxels are")
{
    const CurveRange range{0.0, 4000.0};
    CHECK(wheel_shift(1.0, range, false, true) == 40.0);
    CHECK(wheel_shift(-2.0, range, true, true) == -8.0);
    CHECK(wheel_shift(1.0, {0.0, 255.0}, true, true) == 1.0);
    CHECK(wheel_shift(1.0, {0.0, 1.0}, true, false) == 0.001);
}
