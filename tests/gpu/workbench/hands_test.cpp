// Work by hand: strokes that stay on what they follow, nodes with a radius of their own, cuts that are mended, clicks
// that select, distances.

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/workbench/bindings/shortcuts.h"
#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// A scan of 48^3 voxels: a plate at y = 8 ... 12 for x below 24, and behind it, seen from the front, a wall from 36
/// on.
struct Plates {
    TemporaryFolder folder;
    Workbench bench;

    explicit Plates(Renderer& renderer, const std::string& more = "") : bench(renderer, {.has_servo = false})
    {
        std::string text = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 48 48 48\nspacings: 2 2 2\nencoding: raw\n\n";
        for (int z = 0; z < 48; ++z)
            for (int y = 0; y < 48; ++y)
                for (int x = 0; x < 48; ++x) text += char((y >= 8 && y < 12 && x < 24) || y >= 36 ? 200 : 10);
        folder.write("plates.nrrd", text);
        folder.write("scan.json", R"({"shvr_session": 1, "volume": {"path": "plates.nrrd"},
            "camera": "front", "cameras": {"front": {"projection": "orthographic", "eye": [48, -200, 48],
            "target": [48, 48, 48], "up": [0, 0, 1], "height": 96}}, "render": {"size": [96, 96]},
            "transfer_function": {"points": [{"intensity": 100, "opacity": 0}, {"intensity": 101, "opacity": 0.9},
            {"intensity": 255, "opacity": 0.9}]},
            "probe": {"brush": "fill", "radius_voxels": 2, "paint_threshold": 0)" +
                                      more + "}}");
        bench.set_pixels({96, 96});
        bench.open(folder.path / "scan.json", {});
        settle(bench);
    }
    /// A pixel is half a voxel: x to the right is x of the volume.
    static ProbeAlong along(double x, bool jumps = false) { return {0, {2.0 * x, 48.0}, jumps}; }
    double depth() const { return bench.model().probe_voxel.y; }
    const TraceGraph& trace() const { return bench.model().trace; }
    bool is_painted(int x, int y) const { return bench.document().annotator.document().mask.at({x, y, 24}) == 1; }
    void perform(const Action& action)
    {
        bench.perform(action);
        settle(bench);
    }
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice,
                  "a stroke stays on the surface that it began on, and without a stroke the probe lands on each")
{
    Plates on(renderer());
    on.perform(Plates::along(16.0));
    CHECK(std::abs(on.depth() - 8.0) < 1.0);
    on.perform(Plates::along(30.0));
    CHECK(std::abs(on.depth() - 36.0) < 1.0);

    on.perform(Plates::along(16.0));
    on.perform(Paint{true});
    for (const double x : {18.0, 20.0, 22.0, 25.0, 28.0, 30.0}) {
        CAPTURE(x);
        on.perform(Plates::along(x));
        CHECK(on.depth() < 16.0);
    }
    on.perform(Paint{false});
    CHECK(on.is_painted(20, 8));
    for (int x = 0; x < 48; ++x) CHECK(!on.is_painted(x, 36));
}

TEST_CASE_FIXTURE(OnDevice, "a pointer that jumps paints nothing in between, in one step of the history")
{
    for (const bool jumps : {false, true}) {
        CAPTURE(jumps);
        Plates on(renderer());
        on.perform(PlaceProbe{{8.0, 36.0, 24.0}});
        on.perform(Paint{true});
        on.perform(ProbeTo{0, {80.0, 48.0}, jumps});
        on.perform(Paint{false});
        CHECK(on.is_painted(8, 36));
        CHECK(on.is_painted(40, 36));
        CHECK(on.is_painted(24, 36) == !jumps);
        CHECK(on.bench.model().undoable == 1);
    }
}

TEST_CASE_FIXTURE(OnDevice,
                  "strokes and edits that follow each other faster than the device paints are all done, in order")
{
    Plates on(renderer());
    const auto stroke = [&](double x) {
        on.bench.perform(PlaceProbe{{x, 36.0, 24.0}});
        on.bench.perform(Paint{true});
        on.bench.perform(Paint{false});
    };
    stroke(8.0);
    stroke(20.0);
    REQUIRE(on.bench.model().is_painting);  // nothing has been painted yet
    on.bench.perform(UndoOp{});
    CHECK(on.is_painted(8, 36));
    CHECK(!on.is_painted(20, 36));
    stroke(32.0);
    on.bench.perform(Set{R"({"groups":{"1":{"name":"leaf trace"}}})"});
    stroke(40.0);
    on.bench.perform(NodeOp{.at = {40.0, 36.0, 24.0}, .radius_voxels = {}, .group = {}});
    settle(on.bench);
    CHECK(on.is_painted(32, 36));
    CHECK(on.is_painted(40, 36));
    CHECK(on.bench.model().undoable == 5);
    std::vector<std::string> said;
    for (int i = 0; i < 5; ++i) {
        on.bench.perform(UndoOp{});
        said.push_back(on.bench.messages().last());
    }
    CHECK(said[0].find("node") != std::string::npos);
    CHECK(said[1].find("fill") != std::string::npos);
    CHECK_MESSAGE(said[2].find("fill") == std::string::npos, said[2]);  // the name
    CHECK(said[3].find("fill") != std::string::npos);
    CHECK(said[4].find("fill") != std::string::npos);
}

TEST_CASE_FIXTURE(OnDevice, "a pixel means the same place whether the screen has followed the camera or not")
{
    glm::dvec3 places[2];
    for (const bool settles : {false, true}) {
        Plates on(renderer());
        on.perform(PlaceProbe{{8.0, 36.0, 24.0}});
        for (const Action& action :
             {Action(Orbit{20.0, 10.0}), Action(Zoom{0, {20.0, 30.0}, 2.0}), Action(ProbeTo{0, {70.0, 20.0}})})
            settles ? on.perform(action) : on.bench.perform(action);
        places[settles] = on.bench.model().probe_voxel;
    }
    CHECK(places[0] == places[1]);
}

TEST_CASE_FIXTURE(OnDevice, "the tool that erases takes paint away, whatever the active group is")
{
    Plates on(renderer(), R"(, "group": 1)");
    on.perform(PlaceProbe{{8.0, 36.0, 24.0}});
    on.perform(Paint{true});
    on.perform(Paint{false});
    REQUIRE(on.is_painted(8, 36));
    on.perform(Set{R"({"probe":{"tool":"erase"}})"});
    on.perform(Paint{true});
    on.perform(Paint{false});
    CHECK(!on.is_painted(8, 36));
    CHECK(on.bench.model().brush().group == 1);
}

TEST_CASE_FIXTURE(OnDevice, "nodes have a radius of their own, or that of what they lie in")
{
    Plates on(renderer());
    CHECK(on.bench.model().session.probe.node_radius_voxels == 1.0);  // not the brush's
    on.perform(NodeOp{.at = {16.0, 10.0, 24.0}, .radius_voxels = {}, .group = {}});
    CHECK(on.trace().node(0).radius == 2.0);  // voxels of 2
    on.perform(Set{R"({"probe":{"measured_radius":true,"paint_threshold":105}})"});
    on.perform(NodeOp{.at = {16.0, 9.0, 24.0}, .radius_voxels = {}, .group = {}});
    CHECK(std::abs(on.trace().node(1).radius - 4.0) < 0.15);  // the plate is 4 voxels thick
    on.perform(NodeOp{.at = {16.0, 24.0, 24.0}, .radius_voxels = {}, .group = {}});
    CHECK(on.trace().node(2).radius == 2.0);  // nothing there to measure
    on.perform(NodeOp{.at = {16.0, 9.0, 20.0}, .radius_voxels = 3.0, .group = {}});
    CHECK(on.trace().node(3).radius == 6.0);  // as was said
}

TEST_CASE_FIXTURE(OnDevice,
                  "a clicked node goes into the middle of what is seen, or stays on its wall; in slices as clicked")
{
    Plates on(renderer());
    on.perform(Set{R"({"probe":{"paint_threshold":105}})"});
    on.perform(NodeAt{0, {32.0, 48.0}});  // the plate, from y = 8 to 12
    REQUIRE(on.trace().nodes().size() == 1);
    CHECK(std::abs(on.trace().node(0).position.y - 20.0) < 0.3);  // voxels of 2
    CHECK(std::abs(on.trace().node(0).position.x - 32.0) < 4.0);
    CHECK(glm::distance(on.bench.model().probe_voxel * 2.0, on.trace().node(0).position) < 1e-9);
    on.perform(DeselectOp{});
    on.perform(NodeAt{0, {32.0, 48.0}});  // once more
    CHECK(on.trace().nodes().size() == 1);
    CHECK(on.trace().selection().node() == 0u);
    on.perform(NodeAt{0, {80.0, 48.0}});  // the wall, which goes on to the end of the volume
    CHECK(std::abs(on.trace().node(1).position.y - 72.0) < 2.0);
    on.perform(Set{R"({"probe":{"paint_threshold":250}})"});
    on.perform(NodeAt{0, {32.0, 48.0}});
    CHECK(std::abs(on.trace().node(2).position.y - 16.0) < 2.0);
    CHECK(on.bench.messages().last().find("nothing there has a middle above the paint threshold 250") !=
          std::string::npos);
    on.perform(Set{R"({"probe":{"paint_threshold":105,"centered_nodes":false}})"});
    on.perform(NodeAt{0, {20.0, 48.0}});  // away from the balls of the others
    CHECK(std::abs(on.trace().node(3).position.y - 16.0) < 2.0);
    on.perform(Set{R"({"probe":{"centered_nodes":true},"view":{"arrangement":"slices"}})"});
    const Pane across_z = on.bench.model().panes[1].pane;
    const glm::dvec3 wanted(20.0, 17.0, on.bench.model().probe_voxel.z * 2.0);
    on.perform(NodeAt{1, project(across_z.shot.camera, across_z.pixels(), wanted)->pixel});
    CHECK(glm::distance(on.trace().node(4).position, wanted) < 0.01);
}

TEST_CASE_FIXTURE(OnDevice,
                  "enlarged slices stay under a pointer that leads the probe, and follow a probe sent elsewhere")
{
    Plates on(renderer());
    on.perform(Set{R"({"view":{"arrangement":"slices"}})"});
    const auto center = [&] { return on.bench.model().session.view.slices.center; };
    on.perform(PlaceProbe{{24.5, 24.5, 24.5}});
    on.perform(SaveOp{});
    on.perform(Zoom{1, {24.0, 24.0}, 6.0});
    CHECK(on.bench.model().session.view.slices.zoom == 6.0);
    CHECK(on.bench.model().is_saved);  // as a camera that was moved
    const auto zoomed = center();
    REQUIRE(zoomed.has_value());
    for (const double x : {3.0, 20.0, 45.0}) {
        on.bench.set_pointer(Pointer{1, {x, 24.0}});
        on.perform(ProbeTo{1, {x, 24.0}});
        CHECK(center()->x == zoomed->x);
        CHECK(center()->y == zoomed->y);
    }
    on.bench.set_pointer(std::nullopt);
    on.perform(PlaceProbe{{2.5, 44.5, 24.5}});
    CHECK(center()->x == 2.5);
    CHECK(center()->y == 44.5);
    on.perform(DragInMap{1, {40.0, 0.0}});  // away from it: a hand may look elsewhere
    const auto dragged = center();
    CHECK(dragged->x < 2.5);
    settle(on.bench);
    CHECK(center() == dragged);
    on.perform(FitView{1});
    CHECK(!center());
    CHECK(on.bench.model().session.view.slices.zoom == 1.0);
    // The view of the slices is kept like the camera.
    on.perform(Zoom{2, {24.0, 24.0}, 3.0});
    on.perform(SaveOp{});
    const auto kept = center();
    on.bench.open(on.folder.path / "scan.json", {});
    settle(on.bench);
    CHECK(center() == kept);
}

TEST_CASE_FIXTURE(OnDevice, "the probe goes by single voxels, as the pane under the pointer is seen")
{
    Plates on(renderer());
    on.perform(PlaceProbe{{24.5, 24.5, 24.5}});
    const auto press = [&](const char* id) { on.perform(shortcut_named(id)->action(on.bench.model(), 1.0)); };
    const auto is_at = [&](double x, double y, double z) {
        CHECK(glm::distance(on.bench.model().probe_voxel, glm::dvec3(x, y, z)) < 1e-9);
    };
    press("probe_right");
    is_at(25.5, 24.5, 24.5);
    press("probe_up");
    is_at(25.5, 24.5, 25.5);
    press("probe_away");  // from the front
    is_at(25.5, 25.5, 25.5);
    on.perform(Set{R"({"view":{"arrangement":"slices"}})"});
    const Pane across_z = on.bench.model().panes[1].pane;
    const CameraAxes axes = axes_of(across_z.shot.camera);
    on.bench.set_pointer(Pointer{1, {5.0, 5.0}});
    glm::dvec3 at = on.bench.model().probe_voxel;
    for (const auto& [id, way] : {std::pair{"probe_left", -axes.right},
                                  {"probe_down", -axes.up},
                                  {"probe_away", axes.forward},
                                  {"probe_closer", -axes.forward}}) {
        press(id);
        at += way;
        is_at(at.x, at.y, at.z);
    }
}

TEST_CASE_FIXTURE(OnDevice,
                  "deleting a node between two says that the trace is cut, goes on from one end, and is mended")
{
    Plates on(renderer());
    for (const double x : {10.0, 16.0, 22.0})
        on.perform(NodeOp{.at = {x, 8.0, 24.0}, .radius_voxels = {}, .group = {}});
    on.perform(SelectOp{.near = {}, .number = 1, .within_voxels = {}});
    CHECK(on.bench.why_not(MendCut{}) != "");
    on.perform(DeleteOp{});
    CHECK(on.trace().selection().node() == 0u);
    CHECK(on.bench.messages().last().find("cut between node 0, which is selected, and node 2") != std::string::npos);
    CHECK(on.bench.messages().last().find("Shift + Delete links them") != std::string::npos);
    CHECK(on.bench.why_not(MendCut{}) == "");
    on.perform(MendCut{});
    CHECK(on.trace().internode_between(0, 2).has_value());
    CHECK(on.bench.why_not(MendCut{}) != "");
    // The end of a line is not cut, nor a line whose ends are linked.
    on.perform(NodeOp{.at = {16.0, 8.0, 30.0}, .radius_voxels = {}, .group = {}});
    on.perform(LinkOp{.near = {}, .node = 2});
    on.perform(DeleteOp{});
    CHECK(on.trace().selection().empty());
    on.perform(SelectOp{.near = {}, .number = 2, .within_voxels = {}});
    on.perform(DeleteOp{});
    CHECK(on.trace().selection().empty());
}

TEST_CASE_FIXTURE(OnDevice, "nothing of the trace is selected in a scan that was opened again")
{
    Plates on(renderer());
    on.perform(NodeOp{.at = {10.0, 8.0, 24.0}, .radius_voxels = {}, .group = {}});
    on.perform(SaveOp{});
    on.bench.open(on.folder.path / "scan.json", {});
    settle(on.bench);
    REQUIRE(on.trace().nodes().size() == 1);
    CHECK(on.trace().selection().empty());
    on.perform(NodeOp{.at = {40.0, 36.0, 24.0}, .radius_voxels = {}, .group = {}});
    CHECK(on.trace().internodes().empty());
}

TEST_CASE_FIXTURE(OnDevice, "a click takes the node that is seen, the group where none is, and no node behind a wall")
{
    Plates on(renderer());
    on.perform(NodeOp{.at = {16.0, 7.0, 24.0}, .radius_voxels = {}, .group = {}});  // before the plate
    on.perform(DeselectOp{});
    on.perform(NodeOp{.at = {30.0, 44.0, 24.0}, .radius_voxels = {}, .group = {}});  // deep in the wall
    on.perform(DeselectOp{});
    on.perform(SelectAt{0, {32.0, 48.0}});
    CHECK(on.trace().selection().node() == 0u);
    on.perform(DeselectOp{});
    on.perform(SelectAt{0, {60.0, 48.0}});
    CHECK(on.trace().selection().empty());
    on.perform(SelectOp{.near = {}, .number = 0, .within_voxels = {}});
    on.perform(SelectAt{0, {8.0, 90.0}});  // where nothing is, nothing is selected
    CHECK(on.trace().selection().empty());

    on.perform(PlaceProbe{{40.0, 36.0, 24.0}});
    on.perform(Paint{true});
    on.perform(Paint{false});
    on.perform(Set{R"({"probe":{"group":5}})"});
    on.perform(SelectAt{0, {80.0, 48.0}});
    CHECK(on.bench.model().brush().group == 1);
    on.perform(SelectAt{0, {8.0, 90.0}});  // nothing is painted there
    CHECK(on.bench.model().brush().group == 1);
}

TEST_CASE_FIXTURE(OnDevice, "distances are measured on what is seen, in physical units, and copied as a table")
{
    Plates on(renderer());
    on.perform(MeasureAt{0, {60.0, 48.0}});
    CHECK(on.bench.model().measuring.size() == 1);
    on.perform(MeasureAt{0, {80.0, 48.0}});
    REQUIRE(on.bench.model().measurements.size() == 1);
    const Measurement measured = on.bench.model().measurements[0];
    CHECK(std::abs(measured.points[1].x - measured.points[0].x - 10.0) < 0.01);
    CHECK(on.bench.messages().last().find("Distance 1: 20") == 0);  // voxels of 2
    on.perform(CopyMeasurements{});
    CHECK(on.bench.take_clipboard().starts_with("number\tname\tkind\tlength_"));
    CHECK(on.bench.take_clipboard().empty());
    CHECK(!on.bench.model().is_painting);
    on.perform(ClearMeasurements{});
    CHECK(on.bench.model().measurements.empty());
    on.perform(MeasureAt{0, {60.0, 48.0}});
    on.perform(Set{R"({"probe":{"tool":"paint"}})"});
    CHECK(on.bench.model().measuring.empty());
}

TEST_CASE_FIXTURE(OnDevice, "points of a path are taken back, and the path is kept when another tool is chosen")
{
    Plates on(renderer());
    CHECK_THROWS(on.perform(TakeBackPoint{}));
    on.perform(Set{R"({"probe":{"tool":"measure","measure":"path"}})"});
    on.perform(MeasureAt{0, {60.0, 48.0}});
    CHECK_THROWS(on.perform(MeasureAt{0, {60.0, 48.0}}));  // the same point
    on.perform(MeasureAt{0, {80.0, 48.0}});
    on.perform(MeasureAt{0, {80.0, 40.0}});
    on.perform(TakeBackPoint{});
    CHECK(on.bench.model().measuring.size() == 2);
    on.perform(Set{R"({"probe":{"tool":"turn"}})"});
    CHECK(on.bench.model().measuring.empty());
    REQUIRE(on.bench.model().measurements.size() == 1);
    const auto& said = on.bench.messages().all();
    CHECK(std::ranges::any_of(said, [](const Message& each) { return each.text.starts_with("Path 1: 20"); }));
    on.perform(EndStep{});
    on.perform(UndoOp{});
    CHECK(on.bench.model().measurements.empty());
    on.perform(RedoOp{});
    CHECK(on.bench.model().measurements.size() == 1);
}

TEST_CASE_FIXTURE(OnDevice, "a path is ended, an angle ends by itself, and both are renamed and removed as steps")
{
    Plates on(renderer());
    on.perform(Set{R"({"probe":{"measure":"path"}})"});
    on.perform(MeasureAt{0, {60.0, 48.0}});
    CHECK_THROWS(on.perform(EndMeasure{}));  // a point has no length
    on.perform(MeasureAt{0, {80.0, 48.0}});
    on.perform(MeasureAt{0, {80.0, 40.0}});
    on.perform(EndMeasure{});
    REQUIRE(on.bench.model().measurements.size() == 1);
    CHECK(on.bench.messages().last().find("Path 1: 28") == 0);  // 20 and 8
    on.perform(Set{R"({"probe":{"measure":"angle"}})"});
    for (const glm::dvec2 pixel : {glm::dvec2(80.0, 48.0), {60.0, 48.0}, {60.0, 40.0}}) on.perform(MeasureAt{0, pixel});
    REQUIRE(on.bench.model().measurements.size() == 2);
    CHECK(on.bench.messages().last().find("Angle 1: 90.0") == 0);
    CHECK(on.bench.model().measuring.empty());
    on.perform(EndStep{});
    on.perform(RenameMeasurement{2, "petiole"});
    on.perform(EndStep{});
    CHECK(on.bench.model().measurements[1].name == "petiole");
    on.perform(RemoveMeasurement{1});
    on.perform(EndStep{});
    REQUIRE(on.bench.model().measurements.size() == 1);
    CHECK(on.bench.model().measurements[0].name == "petiole");
    CHECK_THROWS(on.perform(RemoveMeasurement{2}));
    on.perform(UndoOp{});
    CHECK(on.bench.messages().last() == "Undone: removed a measurement");
    on.perform(UndoOp{});
    CHECK(on.bench.model().measurements[1].name == "Angle 1");
}

TEST_CASE_FIXTURE(OnDevice,
                  "distances are work: a step each, undone in order, saved, and where they were when one returns")
{
    Plates on(renderer());
    on.perform(MeasureAt{0, {60.0, 48.0}});
    CHECK(on.bench.model().undoable == 0);
    on.perform(MeasureAt{0, {80.0, 48.0}});
    on.perform(EndStep{});
    on.perform(MeasureAt{0, {60.0, 48.0}});
    on.perform(MeasureAt{0, {60.0, 40.0}});
    on.perform(EndStep{});
    CHECK(on.bench.model().undoable == 2);
    const std::vector<Measurement> two = on.bench.model().session.measurements;
    REQUIRE(two.size() == 2);
    on.perform(ClearMeasurements{});
    on.perform(EndStep{});
    CHECK(on.bench.model().measurements.empty());
    on.perform(UndoOp{});
    CHECK(on.bench.messages().last() == "Undone: removed all measurements");
    CHECK(on.bench.model().session.measurements == two);
    on.perform(UndoOp{});
    CHECK(on.bench.model().measurements.size() == 1);
    on.perform(RedoOp{});
    CHECK(on.bench.model().session.measurements == two);
    on.perform(SaveOp{});
    on.bench.open(on.folder.path / "scan.json", {});
    settle(on.bench);
    CHECK(on.bench.model().session.measurements == two);
    on.perform(UndoOp{});
    CHECK(on.bench.model().measurements.size() == 1);
}

TEST_CASE_FIXTURE(OnDevice, "what is under the probe is read: value, offset, group, depth, and how full the probe is")
{
    Plates on(renderer(), R"(, "density": {"offset": 30})");
    on.perform(PlaceProbe{{16.5, 9.5, 24.5}});
    Reading reading = on.bench.model().reading;
    CHECK(reading.intensity == 200.0);
    CHECK(reading.group == 0);
    CHECK(reading.depth == doctest::Approx(19.0));
    REQUIRE(reading.relevant_share.has_value());
    CHECK(*reading.relevant_share == 1.0);  // the threshold is 0
    on.perform(Set{R"({"probe":{"paint_threshold":100}})"});
    // A ball of radius 2 about the middle of a voxel has 33 voxels, of which 1 lies at y = 7 outside the plate.
    CHECK(*on.bench.model().reading.relevant_share == doctest::Approx(32.0 / 33.0));
    on.perform(Paint{true});
    on.perform(Paint{false});
    reading = on.bench.model().reading;
    CHECK(reading.intensity == 200.0);
    CHECK(reading.offset == 30.0);
    CHECK(reading.group == 1);
    on.perform(PlaceProbe{{-5.0, 9.5, 24.5}});
    CHECK(!on.bench.model().reading.is_inside);

    // Over a slice it is the pointer's place; in the others the probe's.
    on.perform(PlaceProbe{{16.5, 9.5, 24.5}});
    on.perform(Set{R"({"view":{"arrangement":"slices"}})"});
    const Pane across_z = on.bench.model().panes[1].pane;
    REQUIRE(across_z.axis == 2);
    const glm::dvec3 wanted(30.5, 40.5, 24.5);
    const auto at = project(across_z.shot.camera, across_z.pixels(), wanted * 2.0);
    on.bench.set_pointer(Pointer{1, at->pixel});
    settle(on.bench);
    CHECK(glm::distance(on.bench.model().reading.voxel, wanted) < 0.01);
    CHECK(on.bench.model().reading.intensity == 200.0);
    on.bench.set_pointer(Pointer{0, at->pixel});
    settle(on.bench);
    CHECK(on.bench.model().reading.voxel == on.bench.model().probe_voxel);
}

TEST_CASE_FIXTURE(OnDevice, "the view turns about what was chosen, which stays where it is in the picture")
{
    Plates on(renderer());
    const auto place = [&](const glm::dvec3& point) {
        return project(on.bench.model().camera, {96, 96}, point)->pixel;
    };
    on.perform(PlaceProbe{{40.0, 36.0, 30.0}});
    const glm::dvec3 probe = on.bench.model().probe_voxel * 2.0;
    glm::dvec2 before = place(probe);
    on.perform(Orbit{30.0, 10.0});
    CHECK(glm::distance(place(probe), before) > 1.0);
    on.perform(Set{R"({"interaction":{"pivot":"probe"}})"});
    before = place(probe);
    on.perform(Orbit{-20.0, 15.0});
    CHECK(glm::distance(place(probe), before) < 1e-6);
    on.perform(PivotAt{0, {60.0, 48.0}});
    REQUIRE(on.bench.model().picked_pivot.has_value());
    before = place(*on.bench.model().picked_pivot);
    on.perform(Orbit{-20.0, 15.0});
    CHECK(glm::distance(place(*on.bench.model().picked_pivot), before) < 1e-6);
}

TEST_CASE_FIXTURE(OnDevice, "a key for what is so already changes nothing, and is no error")
{
    Plates on(renderer());
    std::vector<std::string> log;
    on.bench.log_to([&](const std::string& line) { log.push_back(line); });
    const uint64_t messages = on.bench.messages().count();
    on.perform(shortcut_named("single_view")->action(on.bench.model(), 1.0));
    CHECK(on.bench.messages().count() == messages);
    REQUIRE(log.size() == 1);
    CHECK_NOTHROW(on.perform(read_action(log[0], "log")));
}

TEST_CASE_FIXTURE(OnDevice, "slices of a scan begin with a contrast in which they are seen")
{
    Plates on(renderer());
    const SliceSettings& slices = on.bench.model().session.view.slices;
    REQUIRE(slices.black.has_value());
    REQUIRE(slices.white.has_value());
    CHECK(*slices.black < 20.0);
    CHECK(*slices.white > 190.0);
    CHECK(on.bench.model().is_saved);  // no change by the user
}

TEST_CASE_FIXTURE(OnDevice, "a stroke that finds nothing says what is there, and the threshold is taken from it")
{
    Plates on(renderer());
    on.perform(Set{R"({"probe":{"paint_threshold":250}})"});
    on.perform(PlaceProbe{{16.0, 10.0, 24.0}});
    on.perform(Paint{true});
    on.perform(Paint{false});
    CHECK(!on.is_painted(16, 10));
    const std::string said = on.bench.messages().last();
    CHECK_MESSAGE(said.ends_with("; here is value 200, and Ctrl + T sets the threshold from it"), said);
    on.perform(shortcut_named("threshold_here")->action(on.bench.model(), 1.0));
    CHECK(on.bench.model().paint_threshold() == 150.0);  // 100 is the least that is drawn
    on.perform(Paint{true});
    on.perform(Paint{false});
    CHECK(on.is_painted(16, 10));
}

TEST_CASE_FIXTURE(OnDevice,
                  "a stroke that finds hardly anything says what is there as well, and one that finds much does not")
{
    Plates on(renderer());
    on.perform(Set{R"({"probe":{"paint_threshold":150,"radius_voxels":6}})"});
    const auto said_at = [&](double y) {
        on.perform(PlaceProbe{{16.0, y, 24.0}});
        on.perform(Paint{true});
        on.perform(Paint{false});
        return on.bench.messages().last();
    };
    const std::string little = said_at(17.2), much = said_at(13.5);  // both between plate and wall
    CHECK(on.is_painted(16, 11));
    CHECK_MESSAGE(little.starts_with("Painted "), little);
    CHECK_MESSAGE(little.ends_with("; here is value 10, and Ctrl + T sets the threshold from it"), little);
    CHECK_MESSAGE(much.starts_with("Painted "), much);
    CHECK_MESSAGE(much.find("here is") == std::string::npos, much);
}

TEST_CASE_FIXTURE(OnDevice, "the probe's ball leaves what it painted to be seen until it moves on")
{
    Plates on(renderer());
    CHECK(on.bench.document().probe_look().ball_share < 0.2);  // a ring, unless it has no outline
    on.perform(Set{R"({"probe":{"paint_threshold":150,"silhouette":false}})"});
    const auto ball = [&] { return on.bench.document().probe_look().ball_share; };
    const auto stroke_at = [&](double y) {
        on.perform(PlaceProbe{{16.0, y, 24.0}});
        on.perform(Paint{true});
        on.perform(Paint{false});
    };
    CHECK(ball() == 1.0);
    stroke_at(10.0);
    CHECK(ball() < 0.2);
    stroke_at(10.0);  // there again, with nothing to add
    CHECK(ball() < 0.2);
    on.perform(PlaceProbe{{16.0, 11.0, 24.0}});
    CHECK(ball() == 1.0);
    stroke_at(26.0);  // finds nothing
    CHECK(ball() == 1.0);
}

TEST_CASE_FIXTURE(OnDevice, "undo after a stroke that changed nothing takes no other step back in its place")
{
    Plates on(renderer());
    on.perform(PlaceProbe{{16.0, 10.0, 24.0}});
    for (int stroke = 0; stroke < 2; ++stroke) {  // the second finds all of it painted
        on.perform(Paint{true});
        on.perform(Paint{false});
    }
    REQUIRE(on.bench.model().undoable == 1);
    on.perform(UndoOp{1});
    CHECK(on.is_painted(16, 10));
    const std::string said = on.bench.messages().last();
    CHECK_MESSAGE(said ==
                      "The last stroke changed nothing, and nothing is undone; the next undo reverts: painted group 1 "
                      "with fill",
                  said);
    on.perform(UndoOp{1});
    CHECK(!on.is_painted(16, 10));
    // A later action is undone at once.
    on.perform(RedoOp{1});
    on.perform(Paint{true});
    on.perform(Paint{false});
    on.perform(Set{R"({"light":{"ambient":0.125}})"});
    on.perform(UndoOp{1});
    CHECK(on.bench.model().session.light.ambient != 0.125);
    CHECK(on.is_painted(16, 10));
}

TEST_CASE_FIXTURE(OnDevice, "a node that is clicked on something wide stays where the probe's ball is seen")
{
    TemporaryFolder folder;
    folder.write("scan.json", R"({"shvr_session": 1, "volume": {"procedural": "sphere", "size": [64, 64, 64]},
        "camera": "front", "cameras": {"front": {"projection": "orthographic", "eye": [32, -200, 32],
        "target": [32, 32, 32], "up": [0, 0, 1], "height": 64}}, "render": {"size": [64, 64]},
        "transfer_function": {"points": [{"intensity": 100, "opacity": 0}, {"intensity": 160, "opacity": 0.9},
        {"intensity": 255, "opacity": 0.9}]}, "probe": {"radius_voxels": 3, "paint_threshold": 120}})");
    Workbench bench(renderer(), {.has_servo = false});
    bench.set_pixels({64, 64});
    bench.open(folder.path / "scan.json", {});
    settle(bench);
    const auto clicked = [&] {
        bench.perform(NodeAt{0, {42.0, 32.0}});
        settle(bench);
        glm::dvec3 last(0.0);
        for (const auto& [number, node] : bench.model().trace.nodes()) last = node.position;
        return last;
    };
    const glm::dvec3 held = clicked();
    CHECK(held.x < 40.0);  // towards the middle, at 32
    CHECK(held.x > 38.9);
    CHECK_MESSAGE(bench.messages().last().find("further aside") != std::string::npos, bench.messages().last());
    bench.perform(Set{R"({"probe":{"radius_voxels":12}})"});
    CHECK(glm::distance(clicked(), glm::dvec3(32.0)) < 0.5);
    CHECK(bench.messages().last().find("further aside") == std::string::npos);
}
