// Text and drawings over pictures, and the effects of mouse motions.

#include <bitset>
#include <cmath>

#include <doctest/doctest.h>

#include "engine/annotation/trace/trace_edit.h"
#include "engine/session/session.h"
#include "engine/workbench/sight/gestures.h"
#include "engine/workbench/sight/hits.h"
#include "engine/workbench/sight/words.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

VolumeInfo scan(const glm::dvec3& spacing, const char* unit)
{
    VolumeInfo info;
    info.size = {512, 256, 512};
    info.spacing = spacing;
    info.unit = unit;
    return info;
}

}  // namespace

TEST_CASE("Lengths have four digits and their unit")
{
    CHECK(length_in_words(451.9634, "um") == "452 \u00b5m");
    CHECK(length_in_words(1.28432, "mm") == "1.284 mm");
    CHECK(length_in_words(12.0, "voxel") == "12 voxels");
    CHECK(length_in_words(1.0, "voxel") == "1 voxel");
    CHECK(length_in_words(-0.0, "mm") == "0 mm");
}

// Kind (Window): integers of five digits and more
TEST_CASE("A reading is the place, the value and the group, in one line")
{
    const VolumeInfo info = scan({0.5, 0.5, 2.0}, "mm");
    Reading reading{.voxel = {120.9, 80.2, 33.5}, .is_inside = true, .intensity = 1234.0, .offset = 0.0, .group = 3};
    CHECK(in_words(reading, info, "aorta") == "voxel 120, 80, 33 (60.45, 40.1, 67 mm): value 1234, group 3 aorta");
    reading.offset = -20.0;
    reading.group = 0;
    CHECK(in_words(reading, info, "") == "voxel 120, 80, 33 (60.45, 40.1, 67 mm): value 1234 - 20");
    reading.intensity = 12083.0;
    reading.offset = 65535.0;
    CHECK(value_in_words(reading) == "value 12083 + 65535");
    reading.intensity = -2147483648.0;
    reading.offset = 0.0;
    CHECK(value_in_words(reading) == "value -2147483648");
    reading.intensity = 0.123456;
    CHECK(value_in_words(reading) == "value 0.1235");
    reading.offset = -20.0;
    reading.intensity.reset();
    CHECK(value_in_words(reading) == "value ... - 20");
    reading.is_inside = false;
    reading.voxel.x = -1.5;
    CHECK(in_words(reading, scan(glm::dvec3(1.0), "voxel"), "") == "voxel -2, 80, 33: outside");
}

TEST_CASE("A slice is told by its number from 1 and the place of its middle")
{
    const VolumeInfo info = scan({1.0, 1.0, 0.006}, "mm");
    CHECK(slice_in_words(2, {0.0, 0.0, 213.7}, info) == "z 213 (0 to 511), 1.281 mm");
    CHECK(slice_in_words(1, {0.0, 900.0, 0.0}, info) == "y 255 (0 to 255), 255.5 mm");
    CHECK(slice_in_words(0, {-3.0, 0.0, 0.0}, scan(glm::dvec3(1.0), "voxel")) == "x 0 (0 to 511)");
}

TEST_CASE("A scale bar is 1, 2 or 5 of a power of ten, in the unit that needs the fewest zeros")
{
    CHECK(scale_bar(1.0, 140.0, "um").text == "100 \u00b5m");
    CHECK(scale_bar(1.0, 140.0, "um").pixels == doctest::Approx(100.0));
    CHECK(scale_bar(20.0, 140.0, "um").text == "2 mm");
    CHECK(scale_bar(20.0, 140.0, "um").pixels == doctest::Approx(100.0));
    CHECK(scale_bar(0.004, 140.0, "mm").text == "500 \u00b5m");
    CHECK(scale_bar(0.5, 140.0, "voxel").text == "50 voxels");
    for (const double unit : {1e-9, 0.37, 6.1, 1e9}) {
        const ScaleBar bar = scale_bar(unit, 140.0, "um");
        CHECK(bar.pixels <= 140.0 * (1.0 + 1e-6));
        CHECK(bar.pixels > 140.0 / 2.6);
    }
    CHECK(scale_bar(0.0, 140.0, "um").pixels == 0.0);
}

TEST_CASE("measurements are shown with the volume's unit, and angles in degrees")
{
    const VolumeInfo volume = scan({2.0, 2.0, 9.0}, "um");
    CHECK(value_in_words({{{10, 10, 10}, {13, 14, 10}}}, volume) == "10 \u00b5m");
    CHECK(value_in_words({{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}}, MeasureKind::path}, volume) == "4 \u00b5m");
    CHECK(value_in_words({{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}}, MeasureKind::angle}, volume) == "90.0\u00b0");
    CHECK(value_in_words({{{1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, MeasureKind::angle}, volume) == "no angle");
}

TEST_CASE("The probe's depth is counted from where what is drawn begins")
{
    const VolumeInfo info = scan({2.0, 1.0, 1.0}, "mm");
    Camera camera;
    camera.eye = {100.0, -500.0, 100.0};
    camera.target = {100.0, 0.0, 100.0};
    camera.up = {0.0, 0.0, 1.0};
    camera.projection = Camera::Projection::orthographic;
    camera.height = 100.0;
    CHECK(depth_below_surface(camera, {}, info, {90.0, 30.0, 80.0}) == doctest::Approx(30.0));
    CutBox plane;
    plane.plane_normal = glm::dvec3(0.0, -1.0, 0.0);
    plane.plane_point = glm::dvec3(0.0, 12.0, 0.0);
    const CutBox box{.lower = {0.0, 12.0, 0.0}, .upper = {512.0, 256.0, 512.0}};
    CHECK(depth_below_surface(camera, plane, info, {90.0, 30.0, 80.0}) ==
          doctest::Approx(depth_below_surface(camera, box, info, {90.0, 30.0, 80.0})));
    CHECK(depth_below_surface(camera, {.lower = {0.0, 12.0, 0.0}, .upper = {512.0, 256.0, 512.0}}, info,
                              {90.0, 30.0, 80.0}) == doctest::Approx(18.0));
    camera.near_distance = 520.0;  // 20 into the volume
    CHECK(depth_below_surface(camera, {}, info, {90.0, 30.0, 80.0}) == doctest::Approx(10.0));
    CHECK(depth_below_surface(camera, {}, info, {90.0, -30.0, 80.0}) == 0.0);
    camera.near_distance = 0.0;
    camera.projection = Camera::Projection::perspective;
    CHECK(depth_below_surface(camera, {}, info, {100.0, 30.0, 100.0}) == doctest::Approx(30.0));
}

TEST_CASE("What no hand does between two events is a jump")
{
    CHECK(!is_jump({100.0, 60.0}, {800, 600}));
    CHECK(is_jump({140.0, 60.0}, {800, 600}));
    CHECK(!is_jump({60.0, 0.0}, {200, 120}));  // a low pane
    CHECK(is_jump({65.0, 0.0}, {200, 120}));
}

TEST_CASE("A drag sideways widens the contrast about its middle, a drag down makes it darker")
{
    const ValueRange range{0.0, 1000.0}, was{200.0, 400.0};
    const ValueRange wide = dragged_contrast(was, range, {0.5, 0.0}),
                     narrow = dragged_contrast(was, range, {-0.25, 0.0});
    CHECK(wide.lower == doctest::Approx(-100.0));
    CHECK(wide.upper == doctest::Approx(700.0));
    CHECK(narrow.upper - narrow.lower == doctest::Approx(100.0));
    const ValueRange dark = dragged_contrast(was, range, {0.0, 0.5});
    CHECK(dark.lower == doctest::Approx(300.0));
    CHECK(dark.upper == doctest::Approx(500.0));
    const ValueRange least = dragged_contrast(was, range, {-10.0, 0.0});
    CHECK(least.upper - least.lower == doctest::Approx(1.0));
}

TEST_CASE("Automatic contrast leaves out the darkest and the brightest few voxels")
{
    VolumeStatistics statistics;
    statistics.minimum = 0.0;
    statistics.maximum = 2560.0;
    statistics.histogram.assign(256, 0);
    statistics.histogram[0] = 1;     // less than 0.5 %
    statistics.histogram[10] = 900;  // intensities 100 ... 110
    statistics.histogram[50] = 99;
    const ValueRange contrast = automatic_contrast(statistics);
    CHECK(contrast.lower == doctest::Approx(100.0));
    CHECK(contrast.upper == doctest::Approx(510.0));
    statistics.histogram[255] = 1;  // an outlier alone does not make it dark
    CHECK(automatic_contrast(statistics).upper == doctest::Approx(510.0));
    statistics.histogram.clear();
    CHECK(automatic_contrast(statistics).upper == 2560.0);
    // The session of a scan with a single value, too, can be read again.
    for (const double value : {0.0, 7.0, -1e30, 3.4e38}) {
        CAPTURE(value);
        VolumeStatistics constant;
        constant.minimum = constant.maximum = value;
        CHECK(automatic_contrast(constant).lower < automatic_contrast(constant).upper);
        CHECK(std::abs(automatic_contrast(constant).upper) <= 3.4e38);
    }
}

TEST_CASE("New nodes are a five hundredth of the diagonal wide, at least a voxel")
{
    VolumeInfo info;
    info.size = {512, 512, 174};
    CHECK(automatic_node_radius(info) == doctest::Approx(1.4895).epsilon(1e-3));
    info.size = {64, 64, 64};
    CHECK(automatic_node_radius(info) == 1.0);
    info.size = {512, 512, 174};
    info.spacing = {2.0, 2.0, 2.0};
    CHECK(automatic_node_radius(info) == doctest::Approx(1.4895).epsilon(1e-3));
}

namespace {

/// Along z, from above, a unit of the volume in a pixel: a pane whose pixel x, y is the point x, 100 - y.
Pane pane_of(Pane::Kind kind)
{
    Camera camera;
    camera.projection = Camera::Projection::orthographic;
    camera.eye = {50.0, 50.0, 200.0};
    camera.target = {50.0, 50.0, 50.0};
    camera.up = {0.0, 1.0, 0.0};
    camera.height = 100.0;
    if (kind == Pane::Kind::slice) {
        camera.near_distance = 149.5;
        camera.far_distance = 150.5;
    }
    Pane pane{.kind = kind, .shot = camera, .box = {{0, 0}, {100, 100}}, .name = "", .axis = -1};
    pane.axis = kind == Pane::Kind::slice ? 2 : -1;
    return pane;
}

TraceGraph three_nodes()
{
    TraceGraph trace;
    const glm::dvec3 positions[] = {{20.0, 50.0, 50.0}, {60.0, 50.0, 50.0}, {60.0, 51.0, 80.0}};
    for (uint32_t i = 0; i < 3; ++i)
        trace.apply(TraceNodeChange{i, {}, TraceNode{positions[i], 2.0, 1}}, Direction::forwards);
    trace.apply(TraceInternodeChange{0, {}, TraceInternode{0, 1, 1}}, Direction::forwards);
    return trace;
}

}  // namespace

TEST_CASE("A click hits the nearest node under it, or else an internode, within a few pixels")
{
    const TraceGraph trace = three_nodes();
    VolumeInfo info;
    info.size = {100, 100, 100};
    const Pane view = pane_of(Pane::Kind::main), slice = pane_of(Pane::Kind::slice);
    CHECK(trace_hit(trace, view, {20.0, 55.0}, info, EVERY_GROUP).node == 0u);
    CHECK(!trace_hit(trace, view, {20.0, 58.0}, info, EVERY_GROUP).node.has_value());
    CHECK(trace_hit(trace, view, {60.0, 50.0}, info, EVERY_GROUP).node == 2u);   // before node 1
    CHECK(trace_hit(trace, slice, {60.0, 50.0}, info, EVERY_GROUP).node == 1u);  // in the plane, where node 2 is not
    CHECK(trace_hit(trace, view, {40.0, 53.0}, info, EVERY_GROUP).internode == 0u);
    CHECK(!trace_hit(trace, view, {40.0, 57.0}, info, EVERY_GROUP).internode.has_value());
    CHECK(trace_hit(trace, view, {40.0, 50.0}, info, EVERY_GROUP).depth == doctest::Approx(150.0));
    // A click that meets none of it counts for the nearest, if that is near enough.
    const auto nearest = [&](double x, double y) {
        return trace_hit(trace, view, {x, y}, info, EVERY_GROUP, SPARE_PIXELS);
    };
    CHECK(nearest(40.0, 63.9).internode == 0u);
    CHECK(!nearest(40.0, 64.1).internode.has_value());
    CHECK(nearest(4.1, 50.0).node == 0u);
    CHECK(!nearest(3.9, 50.0).node.has_value());
    CHECK(nearest(40.0, 53.0).internode == 0u);
    CHECK(nearest(60.0, 50.0).node == 2u);
    CHECK(!trace_hit(TraceGraph(), view, {20.0, 50.0}, info, EVERY_GROUP).node.has_value());
}

// Kind (Touch): a click on nodes and internodes that are not drawn
TEST_CASE("A click hits only what its pane draws of a trace")
{
    const TraceGraph trace = three_nodes();
    VolumeInfo info;
    info.size = {100, 100, 100};
    const Pane view = pane_of(Pane::Kind::main), slice = pane_of(Pane::Kind::slice);
    std::bitset<256> others = EVERY_GROUP;
    for (const auto& [number, node] : trace.nodes()) others.reset(node.group);
    for (const auto& [number, internode] : trace.internodes()) others.reset(internode.group);
    CHECK(!trace_hit(trace, view, {20.0, 55.0}, info, others).node);
    CHECK(!trace_hit(trace, view, {40.0, 50.0}, info, others).internode);
    CHECK(!trace_hit(trace, slice, {60.0, 50.0}, info, others).node);

    Session session;
    CHECK(groups_in_pane(session, view).all());
    session.groups[2].visible = false;
    CHECK(groups_in_pane(session, view).count() == 255);
    CHECK(!groups_in_pane(session, view)[2]);
    session.view.meshes = false;
    CHECK(groups_in_pane(session, view).none());
    CHECK(groups_in_pane(session, slice).count() == 255);
    CHECK(!groups_in_pane(session, slice)[2]);
}

TEST_CASE("a threshold is taken half-way between what is drawn at all and what is here")
{
    CHECK(threshold_at(312.0, 188.0) == 250.0);
    CHECK(threshold_at(100.0, 188.0) == 100.0);
}
