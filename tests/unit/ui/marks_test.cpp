// Lines and words that the window draws over its panes.

#include "engine/workbench/sight/marks.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/workbench/sight/measure_lines.h"
#include "tests/support/model_world.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// A volume of 100^3 voxels of 2 mm, seen from above: a millimetre is a pixel.
struct Panes {
    World world;
    Pane view{.kind = Pane::Kind::main, .shot = Camera(), .box = {{0, 0}, {300, 300}}, .name = "camera"};
    Pane slice{.kind = Pane::Kind::slice, .shot = Camera(), .box = {{300, 0}, {600, 300}}, .name = "slice"};

    Panes()
    {
        world.volume.size = {100, 100, 100};
        world.volume.spacing = glm::dvec3(2.0);
        world.volume.unit = "mm";
        Camera camera;
        camera.projection = Camera::Projection::orthographic;
        camera.eye = {100.0, 100.0, 400.0};
        camera.target = {100.0, 100.0, 100.0};
        camera.up = {0.0, 1.0, 0.0};
        camera.height = 300.0;
        view.shot = camera;
        camera.near_distance = 299.0;  // z = 101 ... 99
        camera.far_distance = 301.0;
        slice.shot = camera;
        slice.shot.is_slice = true;
        slice.axis = 2;
        for (const Pane& pane : {view, slice}) world.panes.push_back({.pane = pane, .view = nullptr});
        world.model.probe_voxel = world.model.tool_voxel = {50.0, 50.0, 50.0};
        world.session.probe.brush.radius_voxels = 10.0;
        InteractionSettings& shown = world.session.interaction;
        shown.axes = shown.scale_bar = shown.probe_label = shown.group_legend = false;
        world.trace.apply(TraceNodeChange{0, {}, TraceNode{{60.0, 100.0, 100.0}, 4.0, 1}}, Direction::forwards);
        world.trace.apply(TraceNodeChange{1, {}, TraceNode{{60.0, 100.0, 160.0}, 4.0, 1}}, Direction::forwards);
    }
    Marks over(const Pane& pane) const { return marks_of(world.model, pane, &pane == &slice); }
    static bool says(const Marks& marks, const std::string& text)
    {
        return std::ranges::any_of(marks.labels, [&](const Label& label) { return label.text == text; });
    }
};

/// Ends of strokes between those distances of a pixel.
ptrdiff_t ends_around(const Marks& marks, const glm::dvec2& pixel, double radius)
{
    return std::ranges::count_if(marks.strokes, [&](const Stroke& stroke) {
        return std::abs(glm::distance(stroke.from, pixel) - radius) < 0.05;
    });
}

}  // namespace

TEST_CASE("In a slice the brush's ring is its cross-section with the plane")
{
    Panes panes;
    CHECK(ends_around(panes.over(panes.slice), {150.0, 150.0}, 20.0) >= 48);
    CHECK(ends_around(panes.over(panes.view), {150.0, 150.0}, 20.0) == 0);
    panes.world.model.probe_voxel.z = 56.0;  // 12 mm off the plane: 16 across
    CHECK(ends_around(panes.over(panes.slice), {150.0, 150.0}, 16.0) >= 48);
    panes.world.model.probe_voxel.z = 61.0;
    CHECK(ends_around(panes.over(panes.slice), {150.0, 150.0}, 16.0) == 0);
    panes.world.model.probe_voxel.z = 50.0;
    panes.world.session.probe.brush.region = RegionShape::box;
    CHECK(ends_around(panes.over(panes.slice), {150.0, 150.0}, std::hypot(20.0, 20.0)) >= 4);
}

TEST_CASE("A slice says which it is, shows the nodes that it passes through, and no others")
{
    Panes panes;
    const Marks marks = panes.over(panes.slice);
    CHECK(Panes::says(marks, "z 50 (0 to 99), 101 mm"));
    CHECK(ends_around(marks, {110.0, 150.0}, 4.0) >= 48);  // node 0; node 1 lies behind it
    Panes other;
    other.world.trace.apply(TraceNodeChange{0, TraceNode{{60.0, 100.0, 100.0}, 4.0, 1}, {}}, Direction::forwards);
    CHECK(ends_around(other.over(other.slice), {110.0, 150.0}, 4.0) == 0);
}

TEST_CASE("A measurement of which a slice shows some sides says so, and what is behind the camera is cut off")
{
    Panes panes;
    const Measurement path{
        {{10.0, 50.0, 50.0}, {30.0, 50.0, 50.0}, {30.0, 50.0, 90.0}, {40.0, 50.0, 90.0}}, MeasureKind::path, "a\nb"};
    const VolumeInfo& volume = panes.world.volume;
    CHECK(label_of(path, 1, volume).text() == "a b: 140 mm");
    CHECK(lines_of(path, panes.view, volume, 1.0).note.empty());
    const MeasureLines in_slice = lines_of(path, panes.slice, volume, 1.0);
    CHECK(in_slice.note == " (seen in part)");
    CHECK(in_slice.sides.size() == 2);  // one in the plane, one through it
    panes.world.session.measurements = {path};
    panes.world.model.measurements = panes.world.session.measurements;
    CHECK(Panes::says(panes.over(panes.view), "a b: 140 mm"));
    CHECK(Panes::says(panes.over(panes.slice), "a b: 140 mm (seen in part)"));

    // From the middle of the scan a line that begins behind the eye is seen where it is in front.
    Camera& camera = panes.view.shot.camera;
    camera.projection = Camera::Projection::perspective;
    camera.eye = {100.0, 100.0, 100.0};
    camera.target = {100.0, 100.0, 0.0};
    const Measurement through{{{50.0, 60.0, 90.0}, {50.0, 60.0, 10.0}}, MeasureKind::distance, ""};
    const MeasureLines seen = lines_of(through, panes.view, volume, 1.0);
    REQUIRE(seen.sides.size() == 1);
    REQUIRE(seen.label.has_value());
    CHECK(seen.note.empty());
    CHECK(lines_of(through, panes.slice, volume, 1.0).note == " (through the slice)");
    const Measurement behind{{{50.0, 60.0, 90.0}, {50.0, 60.0, 70.0}}, MeasureKind::distance, ""};
    CHECK(lines_of(behind, panes.view, volume, 1.0).sides.empty());
}

TEST_CASE("The link that a new node would get is drawn before it is made, with its length")
{
    Panes panes;
    panes.world.session.probe.tool = Tool::trace;
    CHECK(!Panes::says(panes.over(panes.view), "40 mm"));
    panes.world.trace.select({{0}, {}});
    CHECK(Panes::says(panes.over(panes.view), "40 mm"));
    for (const Tool other : {Tool::turn, Tool::measure}) {
        panes.world.session.probe.tool = other;
        CHECK(!Panes::says(panes.over(panes.view), "40 mm"));
    }
}

TEST_CASE("Where the trace has drawn the tools a ring says so, and the link leads there")
{
    Panes panes;
    panes.world.session.probe.tool = Tool::trace;
    panes.world.trace.select({{0}, {}});
    panes.world.model.tool_voxel = {45.0, 50.0, 50.0};  // as the middle of what is touched
    CHECK(Panes::says(panes.over(panes.view), "30 mm"));
    CHECK(ends_around(panes.over(panes.view), {140.0, 150.0}, 5.0) == 0);
    panes.world.model.tool_internode = 7;
    CHECK(ends_around(panes.over(panes.view), {140.0, 150.0}, 5.0) >= 48);
    CHECK(Panes::says(panes.over(panes.view), "30 mm"));
}

TEST_CASE("Measurements are drawn where they are with their names and values, in a slice only near its plane")
{
    Panes panes;
    const Measurement far{{{20.0, 20.0, 80.0}, {30.0, 20.0, 80.0}}},
        near{{{20.0, 20.0, 50.5}, {40.0, 20.0, 50.5}}, MeasureKind::distance, "stem"},
        path{{{20.0, 20.0, 80.0}, {30.0, 20.0, 80.0}, {30.0, 30.0, 80.0}, {40.0, 30.0, 50.5}}, MeasureKind::path, ""};
    const Measurement all[] = {far, near, path};
    panes.world.model.measurements = all;
    CHECK(Panes::says(panes.over(panes.view), "Distance 1: 20 mm"));
    CHECK(Panes::says(panes.over(panes.view), "stem: 40 mm"));
    CHECK(!Panes::says(panes.over(panes.slice), "Distance 1: 20 mm"));
    CHECK(Panes::says(panes.over(panes.slice), "stem: 40 mm"));
    const auto is_path = [](const Label& label) { return label.text.starts_with("Path 3: "); };
    CHECK(std::ranges::count_if(panes.over(panes.view).labels, is_path) == 1);
    CHECK(std::ranges::count_if(panes.over(panes.slice).labels, is_path) == 1);  // its last side comes there
}

TEST_CASE("An angle is drawn with an arc between its sides, and a begun measurement leads to the pointer")
{
    Panes panes;
    const Measurement angle[]{{{{40.0, 20.0, 50.5}, {20.0, 20.0, 50.5}, {20.0, 40.0, 50.5}}, MeasureKind::angle, ""}};
    const size_t before = panes.over(panes.view).strokes.size();
    panes.world.model.measurements = angle;
    CHECK(Panes::says(panes.over(panes.view), "Angle 1: 90.0\u00b0"));
    CHECK(Panes::says(panes.over(panes.slice), "Angle 1: 90.0\u00b0"));
    // Two sides, three points (the vertex twice) and the arc, each line with its halo.
    CHECK(panes.over(panes.view).strokes.size() == before + 2 * (2 + 4 * 48 + 24));
    panes.world.model.measurements = {};
    const glm::dvec3 begun[]{{20.0, 20.0, 50.5}, {30.0, 20.0, 50.5}};
    panes.world.model.measuring = begun;
    panes.world.model.measuring_to = glm::dvec3(30.0, 30.0, 50.5);
    panes.world.session.probe.tool = Tool::measure;
    panes.world.session.probe.measure = MeasureKind::path;
    CHECK(Panes::says(panes.over(panes.view), "40 mm"));
    panes.world.session.probe.measure = MeasureKind::angle;
    CHECK(Panes::says(panes.over(panes.view), "90.0\u00b0"));
}

TEST_CASE("Scale bar, axes and the probe's depth are drawn where they are wanted")
{
    Panes panes;
    CHECK(panes.over(panes.view).labels.size() == 1);  // the pane's name
    InteractionSettings& shown = panes.world.session.interaction;
    shown.axes = shown.scale_bar = shown.probe_label = true;
    panes.world.model.reading.depth = 12.5;
    panes.world.model.reading.relevant_share = 0.25;
    const Marks marks = panes.over(panes.view);
    CHECK(Panes::says(marks, "50 mm"));
    CHECK(Panes::says(marks, "x"));
    CHECK(Panes::says(marks, "y"));
    CHECK(!Panes::says(marks, "z"));  // towards the viewer
    CHECK(Panes::says(marks, "25 % full, 12.5 mm deep"));
    panes.view.shot.camera.projection = Camera::Projection::perspective;
    const Marks deep = panes.over(panes.view);
    CHECK(std::ranges::any_of(deep.labels,
                              [](const Label& label) { return label.text.ends_with("at the middle of the view"); }));
}

TEST_CASE("The words at the probe lie at its left where there is room only there, and are never cut")
{
    Panes panes;
    panes.world.session.interaction.probe_label = true;
    panes.world.model.reading.depth = 12.5;
    panes.world.model.reading.relevant_share = 0.25;
    const auto at_probe = [&](double voxel) {
        panes.world.model.probe_voxel.x = voxel;
        const Marks marks = panes.over(panes.view);
        const auto found = std::ranges::find_if(
            marks.labels, [](const Label& label) { return label.text.find("deep") != std::string::npos; });
        REQUIRE(found != marks.labels.end());
        return *found;
    };
    CHECK(at_probe(10.0).anchor.x == 0.0);
    CHECK(at_probe(10.0).at.x > 70.0);  // of the pane's 300 pixels
    CHECK(at_probe(85.0).anchor.x == 1.0);
    CHECK(at_probe(85.0).at.x < 255.0);
    // Without room on either side they are whole, at most 8 pixels a character.
    const Label middle = at_probe(50.0);
    CHECK(middle.anchor.x == 0.0);
    CHECK(middle.at.x + 8.0 * double(middle.text.size()) <= 300.0);
    CHECK(middle.at.x >= 0.0);
}

TEST_CASE("What is painted or traced is named beside its colour, in the first pane, as far as there is room")
{
    Panes panes;
    panes.world.session.groups[1].name = "leaf trace";
    panes.world.session.groups[7].name = std::string(31, 'a') + "\u00e4bc";
    panes.world.session.groups[7].color = glm::dvec3(0.25, 0.5, 0.75);
    panes.world.model.voxels_by_group[7] = 1;
    CHECK(!Panes::says(panes.over(panes.view), "leaf trace"));
    panes.world.session.interaction.group_legend = true;
    const Marks marks = panes.over(panes.view);
    CHECK(Panes::says(marks, "leaf trace"));
    CHECK(Panes::says(marks, std::string(31, 'a') + "\u00e4..."));
    CHECK(std::ranges::any_of(marks.strokes, [](const Stroke& stroke) {
        return stroke.color == glm::dvec3(0.25, 0.5, 0.75) && stroke.width == 11.0 && stroke.to.x == 288.0;
    }));
    CHECK(!Panes::says(panes.over(panes.slice), "leaf trace"));
    const Marks in_file = marks_of(panes.world.model, panes.view, 0, 1.0, MarksFor::picture);
    CHECK(Panes::says(in_file, "leaf trace"));
    panes.world.model.voxels_by_group.fill(1);
    const Marks many = panes.over(panes.view);
    CHECK(Panes::says(many, "group 8"));
    CHECK(!Panes::says(many, "group 9"));  // 300 pixels have room for nine lines above the scale bar
    CHECK(Panes::says(many, "and 247 more groups"));
}

TEST_CASE("The clip box has a handle for each face that a drag can move, the larger one under the pointer")
{
    Panes panes;
    panes.world.session.cut = {{10.0, 20.0, 30.0}, {90.0, 80.0, 70.0}};
    const glm::dvec2 far_x(230.0, 150.0);  // (90, 50) voxels of 2 mm, which are 2 pixels
    CHECK(ends_around(panes.over(panes.view), far_x, 4.5) == 0);
    panes.world.session.view.cut_box = true;
    for (const Pane* pane : {&panes.view, &panes.slice}) {
        CHECK(ends_around(panes.over(*pane), far_x, 4.5) >= 48);
        CHECK(ends_around(panes.over(*pane), {150.0, 150.0}, 4.5) == 0);  // z is seen end on
    }
    panes.world.model.pointer = Pointer{0, far_x};
    CHECK(ends_around(panes.over(panes.view), far_x, 7.0) >= 48);
    CHECK(ends_around(panes.over(panes.slice), far_x, 7.0) == 0);
}
