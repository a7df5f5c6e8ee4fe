// The registry of actions: ids, arguments as JSON and as text, and refusals in words.

#include <random>
#include <set>

#include <doctest/doctest.h>

#include "engine/workbench/actions/action_rows.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

/// One of each kind, with arguments that are not the defaults.
std::vector<Action> samples()
{
    PaintOp paint{.group = 3, .threshold = 0.1, .radius_voxels = 1.0 / 3.0, .path = {{1, 2.5, 3}, {1e-7, 5, 6}}};
    PaintOp offsets = paint;
    offsets.brush = Brush::speckle;
    offsets.density = DensityBrush{.offset = 17.25, .falloff = Falloff::distance};
    offsets.paints_group = false;
    return {Orbit{0.1, -7.0},
            Roll{33.3},
            Move{{0.1, 0.2, -0.3}},
            Zoom{2, {7.5, 8.25}, 1.1},
            DragInMap{1, {3, -4}},
            LookFrom{"node \"3\", left", true},
            KeepCamera{"a b=c", true},
            ForgetCamera{"x"},
            RenameCamera{"x", "near the leaf"},
            PivotAt{1, {3.5, 4}},
            MoveCut{2, true, -0.01},
            MoveClip{true, 0.25},
            CutObliquely{PlaneChange::flip},
            ResetCuts{},
            UpdateOcclusion{},
            Set{R"({"light":{"ambient":0.45}})"},
            NewGroup{},
            EndStep{},
            AutoContrast{},
            ProbeTo{3, {1.5, 2.5}, true},
            ProbeAlong{3, {1.5, 2.5}, true},
            ProbeOnto{0, {9, 8}},
            PushProbe{1, -2.5},
            GoTo{{4, 5.5, 6}},
            PlaceClips{1.5, 200},
            KeepPreset{"leaf traces"},
            RenamePreset{"a", "b c"},
            ForgetPreset{"a"},
            TakePreset{"/tmp/hot one.json"},
            ShowPasses{false},
            SavePasses{"/tmp/run.json"},
            ComparePasses{"/tmp/run.json"},
            PlaceProbe{{1, 2, 3.125}},
            ScaleProbe{1.1},
            Paint{true},
            paint,
            offsets,
            CombineOp{.group = 3, .with = 4, .how = CombineOp::How::swap},
            IslandsOp{.group = 3, .keep = IslandsOp::Keep::at, .at = glm::dvec3(1, 2.5, 3), .split_from = 10},
            ThresholdOp{.group = 2, .from = -1.5, .limits = {.within = glm::dvec2(-3, 70), .inside = 0}},
            FillHolesOp{.group = 255, .limits = {.only_unpainted = true, .box = VoxelBox{{-1, 0, 2}, {3, 4, 5}}}},
            GrowOp{.group = 1, .distance = 2.5},
            ShrinkOp{.group = 1, .distance = 0.125},
            OpenOp{.group = 1, .distance = 3},
            CloseOp{.group = 1, .distance = 1e-6},
            HollowOp{.group = 1, .wall = 2, .side = HollowOp::Side::both},
            FillBetweenOp{.group = 255, .axis = FillBetweenOp::Axis::y},
            SmoothOp{.distance = 2.5},
            SmoothOp{.groups = {7, 3}, .distance = 0.25, .method = SmoothOp::Method::gaussian},
            GrowSeedsOp{.groups = {7, 3}, .on = GrowSeedsOp::On::inverted, .margin = 4},
            LassoOp{.groups = {3},
                    .view = {.projection = LassoView::Projection::perspective, .eye = {1, 2, 3}},
                    .polygon = {{-0.1, 0.25}, {0.1, 0.25}, {0, -0.125}},
                    .side = LassoOp::Side::outside,
                    .depth = glm::dvec2(0.5, 7.5)},
            LassoOp{.to_group = 9, .view = {.face = LassoView::Face::back}, .polygon = {{1, 2}, {3, 4}, {5, 1}}},
            MaskFromTraceOp{.group = 7, .of = {1, 255}, .limits = {.only_unpainted = true}},
            TraceFromMaskOp{.group = 2, .spur = 0.5, .tolerance = 1e-3},
            DragNode{true},
            NodeOp{{1, 2, 3}, 2.5, uint8_t{4}},
            NodeOp{{1, 2, 3}, {}, {}},
            NodeOp{{1, 2, 3}, {}, {}, 12},
            SelectOp{.near = glm::dvec3(4, 5, 6), .number = {}, .is_internode = true, .within_voxels = 7.5},
            SelectOp{.near = {}, .number = 7, .within_voxels = {}},
            SelectSegmentOp{},
            DeselectOp{},
            LinkOp{.near = {}, .node = 9},
            LinkOp{.near = glm::dvec3(1), .node = {}, .within_voxels = 2.0},
            MoveOp{{7, 8, 9}},
            MoveOp{{7, 8, 9}, glm::dvec3(1, 2, 3)},
            DeleteOp{},
            GroupOp{200},
            RadiusOp{.radius_voxels = 1.5},
            RadiusOp{.of = RadiusOp::Of::internodes, .radius_voxels = {}, .group = 3},
            NodeAt{0, {5, 6}},
            SelectAt{2, {5, 6.5}, true},
            StepNode{true},
            MendCut{},
            MeasureAt{1, {8, 9}},
            EndMeasure{},
            TakeBackPoint{},
            RenameMeasurement{2, "near the leaf"},
            RemoveMeasurement{3},
            ClearMeasurements{},
            CopyMeasurements{},
            UndoOp{3},
            RedoOp{2},
            SaveOp{},
            RevertOp{},
            SaveAs{"/tmp/b.json"},
            CopySession{"/tmp/c.json"},
            ExportTask{.mask = "/tmp/a.tif", .labels = true},
            ImportTask{.volume = "/tmp/v.nrrd", .project = "/tmp/p", .reverse = true},
            LabelTask{.threshold = 7.5},
            EvaluateTask{.truth_mask = "/tmp/t.mask"},
            CancelJob{3},
            Screenshot{true},
            FigureTask{.path = "/tmp/a b.tif",
                       .pixels = {85, 60},
                       .dots_per_inch = 300.0,
                       .is_transparent = true,
                       .elements = {.has_legend = true, .title = "A head", .texts = {{{1, 2, 3}, "a vein"}}}},
            MovieTask{.path = "/tmp/a b.webm", .elements = {.has_color_bar = true, .title = "Turns"}},
            Open{"/tmp/a b.json", "volume.channel=red\nvolume.spacing=[1,1,2]"},
            LookAtFile{"/tmp/a b.nrrd", "volume.frame=2"},
            TakeFile{"/tmp/a b.swc"},
            LoadAnnotation{"/tmp/a b.tif", FileUse::offsets},
            PreviewLoad{"/tmp/a b.tif", FileUse::mask},
            DismissUnclearFile{},
            CorrectSpacing{{0.5, 0.5, 2.0}, "um"},
            DismissNotices{},
            ForgetRecent{"/tmp/gone.nrrd"},
            ChooseBelief{true},
            WorkOnCopy{},
            OpenExample{},
            ChooseKeys{"thesis"},
            BindKeys{"undo", "Ctrl+U F2"},
            AskOpen{false},
            Resize{{640, 480}},
            AwaitKey{"undo"},
            ShowHelp{false},
            ShowManual{},
            ShowMessages{false},
            ShowPalette{false},
            FitView{},
            ResetView{},
            LookAtSelection{},
            Prefer{R"({"layout":null,"theme":"light"})"},
            ShowPreferences{false},
            ShowDialog{Dialog::export_work},
            ShowDialog{Dialog::operation, "fill_holes"},
            PreviewOperation{R"({"op":"grow","group":3,"distance":2})"},
            FocusOn{"menu"},
            ShowFullScreen{false},
            Quit{},
            StayOpen{},
            LetGo{true},
            GrabVolume{true},
            UseDevice{"hid:/dev/hidraw3"},
            FindDevices{},
            CalibrateDevice{},
            KeepLook{.name = "two lines\n", .path = "/looks/a b.json"},
            TakeLook{"xylem"},
            ForgetLook{"xylem"},
            SettleImport{UnfinishedUse::remove},
            RecordStylus{"/scans/a b.trace"},
            StopRecording{},
            FollowStylus{.path = "/scans/hand.trace", .by_hand = false, .node_every_voxels = 2.5}};
}

}  // namespace

TEST_CASE("every action has an id of its own, a name, a group and a meaning")
{
    std::set<std::string> ids;
    REQUIRE(action_rows().size() == std::tuple_size_v<ActionRows>);
    for (const ActionRow& row : action_rows()) {
        CAPTURE(row.id);
        CHECK(ids.insert(row.id).second);
        CHECK(std::string(row.name) != "");
        CHECK(std::string(row.group) != "");
        CHECK(std::string(row.meaning) != "");
    }
}

TEST_CASE("an action is the same after it was written and read, as JSON and as text")
{
    std::set<size_t> kinds;
    for (const Action& action : samples()) {
        const std::string line = line_of(action);
        CAPTURE(line);
        const Action read = read_action(line, "test");
        CHECK(read.index() == action.index());
        CHECK(line_of(read) == line);
        const std::string text = text_of(action);
        CAPTURE(text);
        CHECK(line_of(action_of_text(text)) == line);
        kinds.insert(action.index());
    }
    CHECK(kinds.size() == std::tuple_size_v<ActionRows>);
}

TEST_CASE("what is no action is refused, naming what was found and what was expected")
{
    const auto refusal = [](const char* line) -> std::string {
        try {
            static_cast<void>(read_action(line, "log:3"));
            return "(taken)";
        } catch (const Error& error) {
            return error.what();
        }
    };
    CHECK(refusal("[1]") == "log:3: the document is [1]; expected an object such as {\"op\":\"save\"}");
    CHECK(refusal(R"({"op":"orbit","right":3})") != "(taken)");
    CHECK(refusal(R"({"op":"orbit","right":3})").find("right") != std::string::npos);
    CHECK(refusal(R"({"op":"roll"})").find("degrees is missing") != std::string::npos);
    CHECK(refusal(R"({"op":"zoom","factor":0})").find("factor is 0") != std::string::npos);
    CHECK(refusal(R"({"op":"fly"})").find("fly") != std::string::npos);
    CHECK(refusal(R"({"op":"expect","nodes":3})").find("expected") != std::string::npos);
    CHECK(refusal(R"({"op":"set","values":3})").find("values is 3") != std::string::npos);
    CHECK(refusal(R"({"op":"show_dialog","dialog":"operation","operation":"inflate"})")
              .find("operation is \"inflate\"") != std::string::npos);
    for (const char* text : {"", "orbit 3", "orbit =3", "orbit right_degrees", "fly away=1"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(action_of_text(text), Error);
    }
}

TEST_CASE("values of a text may be bare words")
{
    CHECK(line_of(action_of_text("look_from camera=front")) == R"({"op":"look_from","camera":"front"})");
    CHECK(line_of(action_of_text("keep_camera name=\"my view\"")) == R"({"op":"keep_camera","name":"my view"})");
    CHECK(line_of(action_of_text("move_cut axis=1 upper=true share=-0.5")) ==
          R"({"op":"move_cut","axis":1,"upper":true,"share":-0.5})");
}
