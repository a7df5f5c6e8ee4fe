#include "engine/workbench/bindings/shortcuts.h"

#include <algorithm>
#include <cmath>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/group_steps.h"
#include "engine/workbench/edits/trace_ops.h"
#include "engine/workbench/models/hand_view.h"
#include "engine/workbench/models/preferences.h"
#include "engine/workbench/sight/gestures.h"

namespace shvr::ui {

namespace {

// Steps of a tap.
constexpr double TURN_DEGREES = 3.0;
constexpr double MOVE_HEIGHTS = 0.05;
constexpr double CUT_SHARE = 0.01;
constexpr double CLIP_SHARE = 0.01;
constexpr double PROBE_FACTOR = 1.1;
constexpr double BLEND_STEP = 0.05;
constexpr double STRENGTH_STEP = 0.05;
constexpr double MAX_BLEND = 20.0;

// ---- Functions that make actions. Templates with parameters serve several rows of the table.

template <class Kind>
Action plain(const Model&, double)
{
    return Kind{};
}

template <uint8_t GROUP>
Action choose(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.probe.brush.group = GROUP; });
}

/// Makes an action at the pointer or, without a pointer, at the middle of the first pane.
template <class Kind>
Action at_pointer(const Model& model, double)
{
    Kind action;
    if (model.pointer) {
        action.pane = model.pointer->pane;
        action.pixel = model.pointer->pixel;
    } else if (!model.panes.empty()) {
        action.pixel = 0.5 * glm::dvec2(model.panes[0].pane.pixels());
    }
    return action;
}

/// Makes an action for the pane under the pointer, or for the first pane.
template <class Kind>
Action at_pane(const Model& model, double)
{
    Kind action;
    if (model.pointer) action.pane = model.pointer->pane;
    return action;
}

/// Moves the probe by a voxel in a direction of the view in the pane under the pointer.
template <int AWAY, int RIGHT, int UP>
Action step_probe(const Model& model, double amount)
{
    return PushProbe{model.pointer ? model.pointer->pane : 0, AWAY * amount, RIGHT * amount, UP * amount};
}

/// Shows saved view number NUMBER, in alphabetical order; the camera of the window itself is not counted.
template <size_t NUMBER>
Action look_from_kept(const Model& model, double)
{
    size_t number = 0;
    for (const auto& [name, camera] : model.session.cameras)
        if (name != "window" && ++number == NUMBER) return LookFrom{name};
    return LookFrom{sentence("number ", NUMBER)};
}

Action next_pivot(const Model& model, double)
{
    return edited(model.session, [&](Session& s) {
        Pivot& pivot = s.interaction.pivot;
        pivot = pivot == Pivot::target ? Pivot::probe : Pivot::target;
    });
}

template <bool InteractionSettings::*FLAG>
Action toggle_drawn(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.interaction.*FLAG = !(s.interaction.*FLAG); });
}

Action next_brush(const Model& model, double)
{
    return edited(model.session, [](Session& s) {
        Brush& brush = s.probe.brush.brush;
        brush = BRUSHES[(size_t(brush) + 1) % BRUSHES.size()].brush;
    });
}

Action threshold_here(const Model& model, double)
{
    return edited(model.session, [&](Session& s) {
        const Reading& here = model.reading;
        if (here.is_inside && here.intensity)
            s.probe.brush.threshold = threshold_at(*here.intensity + here.offset, s.transfer_function.lower());
    });
}

template <int DIRECTION>
Action scale_probe(const Model&, double amount)
{
    return ScaleProbe{std::pow(PROBE_FACTOR, DIRECTION * amount)};
}

template <Arrangement ARRANGEMENT>
Action arrange(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.view.arrangement = ARRANGEMENT; });
}

template <bool ViewSettings::*FLAG>
Action toggle_view(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.view.*FLAG = !(s.view.*FLAG); });
}

Action show_all_groups(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.view.solo.reset(); });
}

Action toggle_shading(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.light.shaded = !s.light.shaded; });
}

Action light_over_shoulder(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.light.direction = glm::dvec3(0.0); });
}

Action blend_to_background(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.blend.color.reset(); });
}

Action probe_in_group_color(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.probe.color.reset(); });
}

template <int DIRECTION>
Action scale_workspace(const Model& model, double amount)
{
    return edited(model.session, [&](Session& s) {
        double& scale = s.interaction.workspace_scale;
        scale =
            std::clamp(scale * std::pow(PROBE_FACTOR, DIRECTION * amount), MIN_WORKSPACE_SCALE, MAX_WORKSPACE_SCALE);
    });
}

template <bool ProbeSettings::*FLAG>
Action toggle(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.probe.*FLAG = !(s.probe.*FLAG); });
}

Action next_measure(const Model& model, double)
{
    return edited(model.session, [](Session& s) {
        s.probe.measure = MEASURE_KINDS[(size_t(s.probe.measure) + 1) % std::size(MEASURE_KINDS)].value;
    });
}

/// Switches the preview off, or on for the tool in hand: with those that paint by leaving the choice to the window.
Action toggle_preview(const Model& model, double)
{
    return edited(model.session, [](Session& s) {
        ProbeSettings& probe = s.probe;
        const bool paints = probe.tool == Tool::paint || probe.tool == Tool::erase;
        if (probe.previews())
            probe.preview = false;
        else if (paints)
            probe.preview.reset();
        else
            probe.preview = true;
    });
}

Action next_guidance(const Model& model, double)
{
    return edited(model.session, [](Session& s) {
        s.probe.guidance = PROXY_LAWS[(size_t(s.probe.guidance) + 1) % std::size(PROXY_LAWS)].value;
    });
}

Action next_mode(const Model& model, double)
{
    return edited(model.session, [](Session& s) {
        TouchMode& mode = s.probe.touch.mode;
        mode = TOUCH_MODES[(size_t(mode) + 1) % std::size(TOUCH_MODES)].value;
    });
}

/// Off, then across each axis in turn.
Action next_plane(const Model& model, double)
{
    return edited(model.session, [](Session& s) {
        TouchPlane& plane = s.probe.touch.plane;
        plane = TOUCH_PLANES[(size_t(plane) + 1) % std::size(TOUCH_PLANES)].value;
    });
}

template <int DIRECTION>
Action scale_strength(const Model& model, double amount)
{
    return edited(model.session, [&](Session& s) {
        s.probe.touch.strength = std::clamp(s.probe.touch.strength + STRENGTH_STEP * DIRECTION * amount, 0.0, 1.0);
    });
}

template <bool FeelSettings::*FLAG>
Action toggle_feel(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.probe.touch.*FLAG = !(s.probe.touch.*FLAG); });
}

Action toggle_let_go(const Model& model, double)
{
    return LetGo{!(model.hand && model.hand->is_let_go)};
}

Action toggle_recording(const Model& model, double)
{
    if (model.hand && model.hand->recorded_s) return StopRecording{};
    return RecordStylus{};
}

template <Tool TOOL>
Action take(const Model& model, double)
{
    return edited(model.session, [](Session& s) { s.probe.tool = TOOL; });
}

Action trace_or_turn(const Model& model, double)
{
    return edited(model.session,
                  [](Session& s) { s.probe.tool = s.probe.tool == Tool::trace ? Tool::turn : Tool::trace; });
}

template <int RIGHT, int UP, int FORWARD>
Action move(const Model&, double amount)
{
    return Move{MOVE_HEIGHTS * amount * glm::dvec3(RIGHT, UP, FORWARD)};
}

template <int RIGHT, int UP>
Action orbit(const Model&, double amount)
{
    return Orbit{TURN_DEGREES * RIGHT * amount, TURN_DEGREES * UP * amount};
}

template <int DIRECTION>
Action roll(const Model&, double amount)
{
    return Roll{TURN_DEGREES * DIRECTION * amount};
}

enum class Plane { lower, upper };

template <PlaneChange CHANGE>
Action cut_obliquely(const Model&, double)
{
    return CutObliquely{CHANGE};
}

template <int AXIS, Plane PLANE, int DIRECTION>
Action move_cut(const Model&, double amount)
{
    return MoveCut{AXIS, PLANE == Plane::upper, CUT_SHARE * DIRECTION * amount};
}

template <bool FAR, int DIRECTION>
Action move_clip(const Model&, double amount)
{
    return MoveClip{FAR, CLIP_SHARE * DIRECTION * amount};
}

/// Changes a blend value. Values near 0 become exactly 0, since a value of 0 costs nothing to render.
template <double DistanceBlend::*VALUE, int DIRECTION>
Action blend(const Model& model, double amount)
{
    // The size is limited to 1: a larger size would cover everything beyond some depth with the blend colour.
    constexpr double MOST = VALUE == &DistanceBlend::size ? 1.0 : MAX_BLEND;
    return edited(model.session, [&](Session& s) {
        const double next = std::clamp(s.blend.*VALUE + BLEND_STEP * DIRECTION * amount, 0.0, MOST);
        s.blend.*VALUE = next < 1e-9 ? 0.0 : next;
    });
}

template <uint8_t GROUP>
Action regroup(const Model&, double)
{
    return GroupOp{GROUP};
}

template <int DIRECTION>
Action scale_selected(const Model& model, double amount)
{
    return scaled(model, std::pow(PROBE_FACTOR, DIRECTION * amount));
}

template <int DIRECTION>
Action scale_nodes(const Model& model, double amount)
{
    return scaled_nodes_of_group(model, std::pow(PROBE_FACTOR, DIRECTION * amount));
}

template <class Kind>
Action begin_and_end(const Model&, double amount)
{
    return Kind{amount > 0.0};
}

// ---- The window

template <int DIRECTION>
Action neighbour_group(const Model& model, double)
{
    return edited(model.session, [&](Session& s) { s.probe.brush.group = next_group(model, DIRECTION); });
}

/// Takes back the last point of a measurement that is begun; if there is none, undoes the last step.
Action undo_last(const Model& model, double)
{
    return model.measuring.empty() ? Action(UndoOp{}) : Action(TakeBackPoint{});
}

/// Closes the frontmost dialog or, if there is none, selects the tool with which the mouse turns the view.
Action step_back(const Model& model, double amount)
{
    if (model.shows_palette) return ShowPalette{false};
    if (model.dialog != Dialog::none) return ShowDialog{};
    if (model.shows_preferences) return ShowPreferences{false};
    if (model.shows_help) return ShowHelp{false};
    if (model.shows_messages) return ShowMessages{false};
    if (model.shows_passes) return ShowPasses{false};
    if (model.is_full_screen) return ShowFullScreen{false};
    return take<Tool::turn>(model, amount);
}

template <bool WindowLayout::*FLAG>
Action toggle_shown(const Model& model, double)
{
    const char* const name = FLAG == &WindowLayout::shows_side ? "shows_side" : "shows_tool_bar";
    const char* const value = model.preferences.layout.*FLAG ? "false" : "true";
    return Prefer{sentence("{\"layout\":{\"", name, "\":", value, "}}")};
}

template <Dialog DIALOG>
Action show_dialog(const Model& model, double)
{
    return ShowDialog{model.dialog == DIALOG ? Dialog::none : DIALOG};
}

// ---- The table ------------------------------------------------------------------------------------------------------

using Mode = Shortcut::Mode;
constexpr const char *WORK_KEYS = "Work", *VIEWS_KEYS = "Views", *TOOL_KEYS = "Tools", *PAINTING_KEYS = "Painting",
                     *TRACING_KEYS = "Tracing", *PROBE_KEYS = "Probe", *TURN_KEYS = "Turn the view",
                     *MOVE_KEYS = "Move the view", *CUT_KEYS = "Cutting planes", *CLIP_KEYS = "Clip planes",
                     *BLEND_KEYS = "Distance blending", *HAND_KEYS = "Touch";

/// By one key in both sets.
constexpr Shortcut both(const char* id, const char* group, const char* name, Mode mode,
                        Action (*action)(const Model&, double), const char* keys, bool is_by_position = false)
{
    return {id, group, name, mode, action, {keys, keys}, is_by_position};
}

// In the thesis, letter keys move planes and change blending, and Ctrl reverses them. Today Ctrl+C, Ctrl+V and Ctrl+Y
// have other meanings, and a letter typed by mistake must not cut the volume. In the modern key set, these shortcuts
// therefore have no keys until the user assigns some.
constexpr Shortcut SHORTCUTS[] = {
    {"undo", WORK_KEYS, "Undo", Mode::repeated, undo_last, {"Ctrl+Z", "Ctrl+Z"}},
    {"redo", WORK_KEYS, "Redo", Mode::repeated, plain<RedoOp>, {"Ctrl+Y Ctrl+Shift+Z", "Ctrl+Shift+Z"}},
    {"open",
     WORK_KEYS,
     "Open...",
     Mode::tap,
     [](const Model& model, double) -> Action { return AskOpen{!model.asks_what_to_open}; },
     {"Ctrl+O", "Ctrl+O"}},
    both("open_example", WORK_KEYS, "Open the example", Mode::tap, plain<OpenExample>, ""),
    both("save", WORK_KEYS, "Save", Mode::tap, plain<SaveOp>, "Ctrl+S"),
    both("save_as", WORK_KEYS, "Save as...", Mode::tap, show_dialog<Dialog::save_as>, "Ctrl+Shift+S"),
    both("copy_session", WORK_KEYS, "Copy the session", Mode::tap, plain<CopySession>, ""),
    both("revert", WORK_KEYS, "Revert to the last save", Mode::tap, plain<RevertOp>, ""),
    both("open_with_options", WORK_KEYS, "Open with options...", Mode::tap, show_dialog<Dialog::open_with_options>, ""),
    {"load_annotation", WORK_KEYS, "Load annotation...", Mode::tap, show_dialog<Dialog::load>, {"Ctrl+L", ""}},
    both("load_mesh", WORK_KEYS, "Load a mesh...", Mode::tap, show_dialog<Dialog::load>, ""),
    {"import_scan", WORK_KEYS, "Import as project...", Mode::tap, show_dialog<Dialog::import_scan>, {"Ctrl+I", ""}},
    {"export_work", WORK_KEYS, "Export...", Mode::tap, show_dialog<Dialog::export_work>, {"Ctrl+E", ""}},
    both("label_parts", WORK_KEYS, "Label connected parts...", Mode::tap, show_dialog<Dialog::label>, ""),
    both("operate", WORK_KEYS, "Operations on groups...", Mode::tap, show_dialog<Dialog::operation>, ""),
    both(
        "threshold_group", WORK_KEYS, "Threshold into a group...", Mode::tap,
        [](const Model&, double) -> Action {
            return ShowDialog{Dialog::operation, row_of(GroupOperation(ThresholdOp())).id};
        },
        ""),
    both("compare", WORK_KEYS, "Compare with a reference...", Mode::tap, show_dialog<Dialog::compare>, ""),
    both("correct_spacing", WORK_KEYS, "Correct the spacing...", Mode::tap, show_dialog<Dialog::spacing>, ""),
    {"screenshot", WORK_KEYS, "Screenshot", Mode::tap, plain<Screenshot>, {"F12", "P"}},
    {"large_screenshot",
     WORK_KEYS,
     "Large screenshot",
     Mode::tap,
     [](const Model&, double) -> Action { return Screenshot{true}; },
     {"Shift+F12", "Ctrl+P"}},
    both("screenshot_marks", WORK_KEYS, "Scale bar, axes, groups in screenshots", Mode::tap,
         toggle_drawn<&InteractionSettings::screenshot_marks>, ""),
    both("figure", WORK_KEYS, "Figure...", Mode::tap, show_dialog<Dialog::figure>, ""),
    both("movie", WORK_KEYS, "Movie...", Mode::tap, show_dialog<Dialog::movie>, ""),
    both("keep_look", WORK_KEYS, "Save the look...", Mode::tap, show_dialog<Dialog::keep_look>, ""),
    both("update_occlusion", WORK_KEYS, "Update ambient occlusion", Mode::tap, plain<UpdateOcclusion>, "F8"),
    {"help",
     WORK_KEYS,
     "Keys and mouse",
     Mode::tap,
     [](const Model& model, double) -> Action { return ShowHelp{!model.shows_help}; },
     {"F1", "F12"}},
    both("manual", WORK_KEYS, "User manual", Mode::tap, plain<ShowManual>, ""),
    both(
        "messages", WORK_KEYS, "Messages", Mode::tap,
        [](const Model& model, double) -> Action { return ShowMessages{!model.shows_messages}; }, ""),
    both(
        "palette", WORK_KEYS, "Find anything", Mode::tap,
        [](const Model& model, double) -> Action { return ShowPalette{!model.shows_palette}; }, "Ctrl+Shift+P"),
    both(
        "preferences", WORK_KEYS, "Preferences...", Mode::tap,
        [](const Model& model, double) -> Action { return ShowPreferences{!model.shows_preferences}; }, "Ctrl+,"),
    both(
        "show_hints", WORK_KEYS, "Show the first hints again", Mode::tap,
        [](const Model&, double) -> Action { return Prefer{R"({"hints_seen":0})"}; }, ""),
    both("step_back", WORK_KEYS, "Close, or back to turning", Mode::tap, step_back, "Escape"),
    both(
        "passes", WORK_KEYS, "GPU passes", Mode::tap,
        [](const Model& model, double) -> Action { return ShowPasses{!model.shows_passes}; }, ""),
    both("quit", WORK_KEYS, "Save and quit", Mode::tap, plain<Quit>, "Ctrl+Q"),
    both(
        "quit_unsaved", WORK_KEYS, "Quit without saving", Mode::tap,
        [](const Model&, double) -> Action { return Quit{false}; }, ""),

    both("slices", VIEWS_KEYS, "Slices", Mode::tap, arrange<Arrangement::slices>, "F6"),
    both("overview", VIEWS_KEYS, "Overview", Mode::tap, arrange<Arrangement::overview>, "F9"),
    both("single_view", VIEWS_KEYS, "Single view", Mode::tap, arrange<Arrangement::single>, "F10"),
    {"stereo", VIEWS_KEYS, "Two eyes", Mode::tap, arrange<Arrangement::stereo>, {"Shift+F11", "F11"}},
    {"full_screen",
     VIEWS_KEYS,
     "Full screen",
     Mode::tap,
     [](const Model& model, double) -> Action { return ShowFullScreen{!model.is_full_screen}; },
     {"F11", "Alt+Enter"}},

    both(
        "keep_view", VIEWS_KEYS, "Keep this view", Mode::tap,
        [](const Model&, double) -> Action { return KeepCamera{}; }, "Ctrl+D"),
    both(
        "keep_view_for_movie", VIEWS_KEYS, "Keep this view for a movie", Mode::tap,
        [](const Model&, double) -> Action { return KeepCamera{.name = {}, .with_look = true}; }, "Ctrl+Shift+D"),
    {"kept_view_1", VIEWS_KEYS, "Kept view 1", Mode::tap, look_from_kept<1>, {"Shift+1", ""}},
    {"kept_view_2", VIEWS_KEYS, "Kept view 2", Mode::tap, look_from_kept<2>, {"Shift+2", ""}},
    {"kept_view_3", VIEWS_KEYS, "Kept view 3", Mode::tap, look_from_kept<3>, {"Shift+3", ""}},
    {"kept_view_4", VIEWS_KEYS, "Kept view 4", Mode::tap, look_from_kept<4>, {"Shift+4", ""}},
    {"kept_view_5", VIEWS_KEYS, "Kept view 5", Mode::tap, look_from_kept<5>, {"Shift+5", ""}},
    {"kept_view_6", VIEWS_KEYS, "Kept view 6", Mode::tap, look_from_kept<6>, {"Shift+6", ""}},
    {"kept_view_7", VIEWS_KEYS, "Kept view 7", Mode::tap, look_from_kept<7>, {"Shift+7", ""}},
    {"kept_view_8", VIEWS_KEYS, "Kept view 8", Mode::tap, look_from_kept<8>, {"Shift+8", ""}},
    {"kept_view_9", VIEWS_KEYS, "Kept view 9", Mode::tap, look_from_kept<9>, {"Shift+9", ""}},
    both("pivot_at_pointer", VIEWS_KEYS, "Set pivot under the pointer", Mode::tap, at_pointer<PivotAt>, "O"),
    both("pivot_at_probe", VIEWS_KEYS, "Set pivot to the probe, or the middle", Mode::tap, next_pivot, "Shift+O"),
    both("scale_bar", VIEWS_KEYS, "Scale bar", Mode::tap, toggle_drawn<&InteractionSettings::scale_bar>, ""),
    both("axes", VIEWS_KEYS, "Axes", Mode::tap, toggle_drawn<&InteractionSettings::axes>, ""),
    both("probe_label", VIEWS_KEYS, "Depth and filling at the probe", Mode::tap,
         toggle_drawn<&InteractionSettings::probe_label>, ""),
    both("group_legend", VIEWS_KEYS, "Names of the groups", Mode::tap, toggle_drawn<&InteractionSettings::group_legend>,
         ""),
    both("auto_contrast", VIEWS_KEYS, "Automatic contrast of the slices", Mode::tap, plain<AutoContrast>, "B"),
    both("next_measure", VIEWS_KEYS, "Measure distances, paths or angles in turn", Mode::tap, next_measure, ""),
    both("end_measure", VIEWS_KEYS, "End the measured path", Mode::tap, plain<EndMeasure>, "Enter"),
    both("take_back_point", VIEWS_KEYS, "Take back the last point measured", Mode::tap, plain<TakeBackPoint>,
         "Backspace"),
    {"copy_measurements", VIEWS_KEYS, "Copy the measurements", Mode::tap, plain<CopyMeasurements>, {"Ctrl+C", ""}},
    both("clear_measurements", VIEWS_KEYS, "Remove the measurements", Mode::tap, plain<ClearMeasurements>, ""),
    {"fit_view", VIEWS_KEYS, "Fit", Mode::tap, at_pane<FitView>, {"Home", "Ctrl+Home"}},
    both("reset_view", VIEWS_KEYS, "Reset the view", Mode::tap, plain<ResetView>, "Shift+Home"),
    both("look_at_selection", VIEWS_KEYS, "Look at the selection", Mode::tap, plain<LookAtSelection>, "Alt+Home"),
    both("side_panels", VIEWS_KEYS, "Panels at the side", Mode::tap, toggle_shown<&WindowLayout::shows_side>, "Ctrl+B"),
    both("tool_bar", VIEWS_KEYS, "Tool bar", Mode::tap, toggle_shown<&WindowLayout::shows_tool_bar>, ""),
    both(
        "reset_layout", VIEWS_KEYS, "Reset the layout", Mode::tap,
        [](const Model&, double) -> Action { return Prefer{R"({"layout":null})"}; }, ""),
    both("focus_panels", VIEWS_KEYS, "Use the panels by keyboard", Mode::tap, plain<FocusOn>, "Ctrl+F6"),
    both(
        "focus_menu", VIEWS_KEYS, "Use the menu by keyboard", Mode::tap,
        [](const Model&, double) -> Action { return FocusOn{"menu"}; }, "Shift+F10"),
    both("volume", VIEWS_KEYS, "Volume", Mode::tap, toggle_view<&ViewSettings::volume>, "F2"),
    both("meshes", VIEWS_KEYS, "Nodes, internodes and probe", Mode::tap, toggle_view<&ViewSettings::meshes>, "F3"),
    both("show_all_groups", VIEWS_KEYS, "Show all groups again", Mode::tap, show_all_groups, ""),
    both("shading", VIEWS_KEYS, "Shading", Mode::tap, toggle_shading, ""),
    both("light_over_shoulder", VIEWS_KEYS, "Light over the shoulder", Mode::tap, light_over_shoulder, ""),
    both("blend_to_background", VIEWS_KEYS, "Distance blending in the background's colour", Mode::tap,
         blend_to_background, ""),
    both("cut_box", VIEWS_KEYS, "Clip box with handles", Mode::tap, toggle_view<&ViewSettings::cut_box>, ""),
    both("oblique_cut", VIEWS_KEYS, "Oblique cutting plane, facing the view", Mode::tap,
         cut_obliquely<PlaneChange::add>, ""),
    both("flip_oblique_cut", VIEWS_KEYS, "Flip the oblique cutting plane", Mode::tap, cut_obliquely<PlaneChange::flip>,
         ""),
    both("remove_oblique_cut", VIEWS_KEYS, "Remove the oblique cutting plane", Mode::tap,
         cut_obliquely<PlaneChange::remove>, ""),
    both("plane_handles", VIEWS_KEYS, "Handles of the oblique cutting plane", Mode::tap,
         toggle_view<&ViewSettings::plane_handles>, ""),
    both("show_everything", VIEWS_KEYS, "Show everything", Mode::tap, plain<ResetCuts>, ""),
    both("no_clip_planes", VIEWS_KEYS, "No clip planes", Mode::tap, plain<PlaceClips>, ""),

    both("tool_turn", TOOL_KEYS, "Turn with the mouse", Mode::tap, take<Tool::turn>, "Alt+1"),
    both("tool_paint", TOOL_KEYS, "Paint with the mouse", Mode::tap, take<Tool::paint>, "Alt+2"),
    both("tool_erase", TOOL_KEYS, "Erase with the mouse", Mode::tap, take<Tool::erase>, "Alt+3"),
    both("tool_trace", TOOL_KEYS, "Trace with the mouse", Mode::tap, take<Tool::trace>, "Alt+4"),
    both("tool_select", TOOL_KEYS, "Select with the mouse", Mode::tap, take<Tool::select>, "Alt+5"),
    both("tool_measure", TOOL_KEYS, "Measure with the mouse", Mode::tap, take<Tool::measure>, "Alt+6"),

    both("paint", PAINTING_KEYS, "Paint while held", Mode::while_held, begin_and_end<Paint>, "F Stylus1"),
    both("preview", PAINTING_KEYS, "Preview of the brush", Mode::tap, toggle_preview, "F5"),
    both("eraser", PAINTING_KEYS, "Eraser", Mode::tap, choose<0>, "0"),
    both("group_1", PAINTING_KEYS, "Group 1", Mode::tap, choose<1>, "1"),
    both("group_2", PAINTING_KEYS, "Group 2", Mode::tap, choose<2>, "2"),
    both("group_3", PAINTING_KEYS, "Group 3", Mode::tap, choose<3>, "3"),
    both("group_4", PAINTING_KEYS, "Group 4", Mode::tap, choose<4>, "4"),
    both("group_5", PAINTING_KEYS, "Group 5", Mode::tap, choose<5>, "5"),
    both("group_6", PAINTING_KEYS, "Group 6", Mode::tap, choose<6>, "6"),
    both("group_7", PAINTING_KEYS, "Group 7", Mode::tap, choose<7>, "7"),
    both("group_8", PAINTING_KEYS, "Group 8", Mode::tap, choose<8>, "8"),
    both("group_9", PAINTING_KEYS, "Group 9", Mode::tap, choose<9>, "9"),
    both("next_group", PAINTING_KEYS, "Next group", Mode::tap, neighbour_group<1>, "Alt+PageDown"),
    both("previous_group", PAINTING_KEYS, "Previous group", Mode::tap, neighbour_group<-1>, "Alt+PageUp"),
    both("new_group", PAINTING_KEYS, "New group", Mode::tap, plain<NewGroup>, "Ctrl+G"),
    {"threshold_here", PAINTING_KEYS, "Set paint threshold from the probe", Mode::tap, threshold_here, {"Ctrl+T", ""}},
    both("next_brush", PAINTING_KEYS, "Next brush", Mode::tap, next_brush, "End"),
    both("larger_brush", PAINTING_KEYS, "Larger brush", Mode::hold, scale_probe<1>, "]"),
    both("smaller_brush", PAINTING_KEYS, "Smaller brush", Mode::hold, scale_probe<-1>, "["),

    both("next_tool", TRACING_KEYS, "Trace, or back to turning", Mode::tap, trace_or_turn, "X"),
    both(
        "add_node", TRACING_KEYS, "Add a node, linked with the selected one", Mode::tap,
        [](const Model& model, double) -> Action { return node_or_link_at_probe(model); }, "N"),
    both("drag_node", TRACING_KEYS, "Move the selection while held", Mode::while_held, begin_and_end<DragNode>, "M"),
    both(
        "link_nearest", TRACING_KEYS, "Link the selected node with the nearest", Mode::tap,
        [](const Model& model, double) -> Action { return link_with_nearest(model); }, ","),
    both(
        "select_nearest", TRACING_KEYS, "Select the nearest node, then its internode", Mode::tap,
        [](const Model& model, double) -> Action { return nearest_selection(model); }, "."),
    both("select_segment", TRACING_KEYS, "Select the whole segment", Mode::tap, plain<SelectSegmentOp>, "Shift+."),
    both("deselect", TRACING_KEYS, "Deselect", Mode::tap, plain<DeselectOp>, "/ Ctrl+Shift+A"),
    both(
        "next_node", TRACING_KEYS, "Look at the next node", Mode::tap,
        [](const Model&, double) -> Action { return StepNode{false}; }, "G"),
    both(
        "previous_node", TRACING_KEYS, "Look at the node before", Mode::tap,
        [](const Model&, double) -> Action { return StepNode{true}; }, "Shift+G"),
    both("mend_cut", TRACING_KEYS, "Mend the cut", Mode::tap, plain<MendCut>, "Shift+Delete"),
    both("measured_radius", TRACING_KEYS, "Fit new node radius to the structure", Mode::tap,
         toggle<&ProbeSettings::measured_radius>, ""),
    both("centered_nodes", TRACING_KEYS, "Centre clicked nodes in the structure", Mode::tap,
         toggle<&ProbeSettings::centered_nodes>, ""),
    both("delete_selected", TRACING_KEYS, "Delete the selection", Mode::tap, plain<DeleteOp>, "Delete"),
    both("larger_selected", TRACING_KEYS, "Larger selected nodes, or internodes of the group", Mode::step,
         scale_selected<1>, "="),
    both("smaller_selected", TRACING_KEYS, "Smaller selected nodes, or internodes of the group", Mode::step,
         scale_selected<-1>, "-"),
    both("larger_nodes", TRACING_KEYS, "Larger nodes of the group", Mode::step, scale_nodes<1>, "Alt+="),
    both("smaller_nodes", TRACING_KEYS, "Smaller nodes of the group", Mode::step, scale_nodes<-1>, "Alt+-"),
    both("regroup_0", TRACING_KEYS, "Selected to no group", Mode::tap, regroup<0>, "Ctrl+0"),
    both("regroup_1", TRACING_KEYS, "Selected to group 1", Mode::tap, regroup<1>, "Ctrl+1"),
    both("regroup_2", TRACING_KEYS, "Selected to group 2", Mode::tap, regroup<2>, "Ctrl+2"),
    both("regroup_3", TRACING_KEYS, "Selected to group 3", Mode::tap, regroup<3>, "Ctrl+3"),
    both("regroup_4", TRACING_KEYS, "Selected to group 4", Mode::tap, regroup<4>, "Ctrl+4"),
    both("regroup_5", TRACING_KEYS, "Selected to group 5", Mode::tap, regroup<5>, "Ctrl+5"),
    both("regroup_6", TRACING_KEYS, "Selected to group 6", Mode::tap, regroup<6>, "Ctrl+6"),
    both("regroup_7", TRACING_KEYS, "Selected to group 7", Mode::tap, regroup<7>, "Ctrl+7"),
    both("regroup_8", TRACING_KEYS, "Selected to group 8", Mode::tap, regroup<8>, "Ctrl+8"),
    both("regroup_9", TRACING_KEYS, "Selected to group 9", Mode::tap, regroup<9>, "Ctrl+9"),

    both("guide", PROBE_KEYS, "Guidance", Mode::tap, toggle<&ProbeSettings::guided>, "Space"),
    both("probe_onto", PROBE_KEYS, "Put the probe onto the surface under the pointer", Mode::tap, at_pointer<ProbeOnto>,
         "L"),
    both("shell", PROBE_KEYS, "Iso-surface around the probe", Mode::tap, toggle<&ProbeSettings::shell>, "F4"),
    both("next_guidance", PROBE_KEYS, "Next kind of guidance", Mode::tap, next_guidance, "Shift+Space"),
    {"arrow", PROBE_KEYS, "Arrow towards the probe", Mode::tap, toggle<&ProbeSettings::arrow>, {"Shift+F1", "F1"}},
    both("silhouette", PROBE_KEYS, "Silhouette of the probe", Mode::tap, toggle<&ProbeSettings::silhouette>, ""),
    both("probe_in_group_color", PROBE_KEYS, "Probe in the colour of its group", Mode::tap, probe_in_group_color, ""),
    both("probe_left", PROBE_KEYS, "Probe a voxel to the left", Mode::repeated, step_probe<0, -1, 0>, "Left"),
    both("probe_right", PROBE_KEYS, "Probe a voxel to the right", Mode::repeated, step_probe<0, 1, 0>, "Right"),
    both("probe_up", PROBE_KEYS, "Probe a voxel up", Mode::repeated, step_probe<0, 0, 1>, "Up"),
    both("probe_down", PROBE_KEYS, "Probe a voxel down", Mode::repeated, step_probe<0, 0, -1>, "Down"),
    both("probe_away", PROBE_KEYS, "Probe a voxel away: the next slice", Mode::repeated, step_probe<1, 0, 0>, "Alt+Up"),
    both("probe_closer", PROBE_KEYS, "Probe a voxel closer: the slice before", Mode::repeated, step_probe<-1, 0, 0>,
         "Alt+Down"),
    both("larger_workspace", PROBE_KEYS, "Larger workspace", Mode::hold, scale_workspace<1>, "F7"),
    both("smaller_workspace", PROBE_KEYS, "Smaller workspace", Mode::hold, scale_workspace<-1>, "Ctrl+F7"),
    both("larger_probe", PROBE_KEYS, "Larger probe", Mode::hold, scale_probe<1>, "PageUp"),
    both("smaller_probe", PROBE_KEYS, "Smaller probe", Mode::hold, scale_probe<-1>, "PageDown"),

    both("turn_up", TURN_KEYS, "Turn up", Mode::hold, orbit<0, 1>, "Alt+W", true),
    both("turn_down", TURN_KEYS, "Turn down", Mode::hold, orbit<0, -1>, "Alt+S", true),
    both("turn_left", TURN_KEYS, "Turn left", Mode::hold, orbit<-1, 0>, "Alt+A", true),
    both("turn_right", TURN_KEYS, "Turn right", Mode::hold, orbit<1, 0>, "Alt+D", true),
    both("roll_left", TURN_KEYS, "Roll left", Mode::hold, roll<-1>, "Alt+Q", true),
    both("roll_right", TURN_KEYS, "Roll right", Mode::hold, roll<1>, "Alt+E", true),

    both("move_forward", MOVE_KEYS, "Move forward", Mode::hold, move<0, 0, 1>, "W", true),
    both("move_back", MOVE_KEYS, "Move back", Mode::hold, move<0, 0, -1>, "S", true),
    both("move_left", MOVE_KEYS, "Move left", Mode::hold, move<-1, 0, 0>, "A", true),
    both("move_right", MOVE_KEYS, "Move right", Mode::hold, move<1, 0, 0>, "D", true),
    // In the thesis (4.2.3), Q moves up and E moves down; here, Q moves down and E up, as in present programs.
    {"move_down", MOVE_KEYS, "Move down", Mode::hold, move<0, -1, 0>, {"Q", "E"}, true},
    {"move_up", MOVE_KEYS, "Move up", Mode::hold, move<0, 1, 0>, {"E", "Q"}, true},

    {"near_x_in", CUT_KEYS, "Near x cut inwards", Mode::hold, move_cut<0, Plane::lower, 1>, {"", "Y"}},
    {"near_x_out", CUT_KEYS, "Near x cut outwards", Mode::hold, move_cut<0, Plane::lower, -1>, {"", "Ctrl+Y"}},
    {"near_y_in", CUT_KEYS, "Near y cut inwards", Mode::hold, move_cut<1, Plane::lower, 1>, {"", "U"}},
    {"near_y_out", CUT_KEYS, "Near y cut outwards", Mode::hold, move_cut<1, Plane::lower, -1>, {"", "Ctrl+U"}},
    {"near_z_in", CUT_KEYS, "Near z cut inwards", Mode::hold, move_cut<2, Plane::lower, 1>, {"", "I"}},
    {"near_z_out", CUT_KEYS, "Near z cut outwards", Mode::hold, move_cut<2, Plane::lower, -1>, {"", "Ctrl+I"}},
    {"far_x_in", CUT_KEYS, "Far x cut inwards", Mode::hold, move_cut<0, Plane::upper, -1>, {"", "H"}},
    {"far_x_out", CUT_KEYS, "Far x cut outwards", Mode::hold, move_cut<0, Plane::upper, 1>, {"", "Ctrl+H"}},
    {"far_y_in", CUT_KEYS, "Far y cut inwards", Mode::hold, move_cut<1, Plane::upper, -1>, {"", "J"}},
    {"far_y_out", CUT_KEYS, "Far y cut outwards", Mode::hold, move_cut<1, Plane::upper, 1>, {"", "Ctrl+J"}},
    {"far_z_in", CUT_KEYS, "Far z cut inwards", Mode::hold, move_cut<2, Plane::upper, -1>, {"", "K"}},
    {"far_z_out", CUT_KEYS, "Far z cut outwards", Mode::hold, move_cut<2, Plane::upper, 1>, {"", "Ctrl+K"}},

    {"more_blending", BLEND_KEYS, "More distance blending", Mode::hold, blend<&DistanceBlend::size, 1>, {"", "T"}},
    {"less_blending",
     BLEND_KEYS,
     "Less distance blending",
     Mode::hold,
     blend<&DistanceBlend::size, -1>,
     {"", "Ctrl+T"}},
    {"later_blending", BLEND_KEYS, "Blending sets in later", Mode::hold, blend<&DistanceBlend::rate, 1>, {"", "R"}},
    {"sooner_blending",
     BLEND_KEYS,
     "Blending sets in sooner",
     Mode::hold,
     blend<&DistanceBlend::rate, -1>,
     {"", "Ctrl+R"}},

    {"near_clip_away", CLIP_KEYS, "Near clip plane away", Mode::hold, move_clip<false, 1>, {"", "C"}},
    {"near_clip_closer", CLIP_KEYS, "Near clip plane closer", Mode::hold, move_clip<false, -1>, {"", "Ctrl+C"}},
    {"far_clip_closer", CLIP_KEYS, "Far clip plane closer", Mode::hold, move_clip<true, -1>, {"", "V"}},
    {"far_clip_away", CLIP_KEYS, "Far clip plane away", Mode::hold, move_clip<true, 1>, {"", "Ctrl+V"}},

    {"next_mode", HAND_KEYS, "Next way of touching", Mode::tap, next_mode, {"Ctrl+Space", "Home"}},
    both("let_go", HAND_KEYS, "Let go: no force", Mode::tap, toggle_let_go, "Pause"),
    both("grab_volume", HAND_KEYS, "Move the volume with the stylus while held", Mode::while_held,
         begin_and_end<GrabVolume>, "Stylus2"),
    both("stronger", HAND_KEYS, "Stronger", Mode::hold, scale_strength<1>, "Ctrl+]"),
    both("weaker", HAND_KEYS, "Weaker", Mode::hold, scale_strength<-1>, "Ctrl+["),
    both("next_plane", HAND_KEYS, "Hold the probe in the next plane", Mode::tap, next_plane, ""),
    both("at_proxy", HAND_KEYS, "Act at the middle of the touched part", Mode::tap,
         toggle_feel<&FeelSettings::at_proxy>, ""),
    both("overlap_radius", HAND_KEYS, "Fit new node radius to what is felt", Mode::tap,
         toggle_feel<&FeelSettings::overlap_radius>, ""),
    both("to_nodes", HAND_KEYS, "Act at nodes in the probe's ball", Mode::tap, toggle_feel<&FeelSettings::to_nodes>,
         ""),
    both("to_lines", HAND_KEYS, "Act on centre lines in the probe's ball", Mode::tap,
         toggle_feel<&FeelSettings::to_lines>, ""),
    both("feels_hidden", HAND_KEYS, "Feel what the picture does not show", Mode::tap,
         toggle_feel<&FeelSettings::feels_hidden>, ""),
    both("clicks", HAND_KEYS, "Click where contact begins", Mode::tap, toggle_feel<&FeelSettings::clicks>, ""),
    both("record_stylus", HAND_KEYS, "Record the stylus, or end it", Mode::tap, toggle_recording, ""),
    both("find_devices", HAND_KEYS, "Look for devices", Mode::tap, plain<FindDevices>, ""),
    both("calibrate_device", HAND_KEYS, "Calibrate the haptic device", Mode::tap, plain<CalibrateDevice>, ""),
};

}  // namespace

std::span<const Shortcut> shortcuts()
{
    return SHORTCUTS;
}

const Shortcut* shortcut_named(std::string_view id)
{
    const auto found = std::ranges::find_if(SHORTCUTS, [&](const Shortcut& each) { return each.id == id; });
    return found == std::end(SHORTCUTS) ? nullptr : &*found;
}

std::string why_not(const Model& model, const Shortcut& shortcut)
{
    return why_not(model, shortcut.action(model, 1.0));
}

}  // namespace shvr::ui
