#include "ui/workbench/action_rows.h"

#include <algorithm>
#include <array>

#include "engine/base/text.h"
#include "engine/session/fields.h"
#include "engine/session/session_patch.h"

namespace shvr::ui {

namespace {

// ---- The table, in the order of the alternatives of Action ----------------------------------------------------------

constexpr const char *LOOKING = "Looking", *SETTINGS = "Settings", *PROBE = "Probe", *PAINTING = "Painting",
                     *TRACING = "Tracing", *MEASURING = "Measuring", *WORK = "Work", *WINDOW = "Window",
                     *HAND = "Touch";

constexpr ActionRow ROWS[] = {
    {"orbit", "Turn the view", LOOKING, "turns the camera about its target, to the right and up"},
    {"roll", "Roll the view", LOOKING, "turns the camera about its line of sight"},
    {"move_view", "Move the view", LOOKING, "moves the camera right, up and forward, in heights of the view"},
    {"zoom", "Zoom", LOOKING, "brings what lies under a pixel of a pane nearer by a factor; in a slice, all slices"},
    {"drag_in_map", "Move the camera in a map", LOOKING, "moves the camera with the mouse in a map, or the slices"},
    {"look_from", "Look from", LOOKING, "takes a camera of the session, or a side of the volume"},
    {"keep_camera", "Keep this view", LOOKING, "keeps the present view in the session, under a name"},
    {"forget_camera", "Forget a view", LOOKING, "removes a camera of the session"},
    {"rename_camera", "Rename a view", LOOKING, "gives a camera of the session another name"},
    {"pivot_at", "Turn about what is seen", LOOKING, "turning goes about what is seen at a pixel of a pane"},
    {"go_to", "Go to", LOOKING, "the camera looks at a voxel, from the same side and as far away as before"},
    {"move_cut", "Move a cutting plane", LOOKING, "moves one of the six planes by a share of the volume's size"},
    {"move_clip", "Move a clip plane", LOOKING, "moves the near or far plane by a share of the distance to the target"},
    {"place_clips", "Place the clip planes", LOOKING, "puts the near and the far plane at distances from the eye"},
    {"reset_cuts", "Remove all planes", LOOKING, "shows the whole volume"},
    {"fit_view", "Fit", LOOKING,
     "brings the volume, or what is not cut away of it, into sight; in a slice, the slices"},
    {"reset_view", "Reset the view", LOOKING, "takes the camera that the session opens with"},
    {"look_at_selection", "Look at what is selected", LOOKING, "moves what is selected into the middle of the view"},
    {"update_occlusion", "Update ambient occlusion", LOOKING, "computes it anew where it is not automatic"},
    {"set", "Change settings", SETTINGS, "sets any keys of the session; null takes a key's default"},
    {"new_group", "New group", SETTINGS, "makes the first group that nothing uses yet the active one"},
    {"end_step", "End the step", SETTINGS, "makes one step of what was set since the last; it comes by itself"},
    {"auto_contrast", "Contrast of the slices", SETTINGS, "sets black and white so that almost all lies between them"},
    {"keep_preset", "Keep the transfer function", SETTINGS, "keeps it under a name, for all scans"},
    {"rename_preset", "Rename a transfer function", SETTINGS, "gives one that was kept another name"},
    {"forget_preset", "Forget a transfer function", SETTINGS, "removes one that was kept"},
    {"take_preset", "Take a transfer function", SETTINGS, "takes the transfer function of a file"},
    {"probe_to", "Move the probe", PROBE, "the probe goes to a pixel of a pane, in its plane"},
    {"probe_onto", "Put the probe onto what is seen", PROBE, "the probe goes to the surface seen at a pixel of a pane"},
    {"probe_along", "Move the probe along what is seen", PROBE, "the probe follows what is seen, as a stroke does"},
    {"push_probe", "Push the probe", PROBE, "the probe goes away from the viewer of a pane, to the right and up"},
    {"place_probe", "Place the probe", PROBE, "the probe goes to a voxel"},
    {"scale_probe", "Resize the probe", PROBE, "the probe and its brush grow by a factor"},
    {"paint_here", "Paint at the probe", PAINTING, "begins or ends a stroke at the probe; when tracing, adds a node"},
    {"paint", "Paint along a path", PAINTING, "paints a whole stroke with a brush of its own (`density`: offsets)"},
    {"drag_node", "Move the selected node", TRACING, "the selected node goes with the probe until it is let go"},
    {"node", "Add a node", TRACING, "adds a node, linked with the selected one"},
    {"select", "Select", TRACING, "selects a node or an internode, by number or the nearest"},
    {"select_segment", "Select the segment", TRACING, "selects all between two branchings or ends"},
    {"deselect", "Deselect", TRACING, "selects nothing"},
    {"link", "Link", TRACING, "links the selected node with another"},
    {"move", "Move to", TRACING, "moves the selected node to a voxel"},
    {"delete", "Delete", TRACING, "deletes what is selected"},
    {"group", "Change group", TRACING, "gives what is selected to a group"},
    {"radius", "Change radius", TRACING, "sets radii of what is selected, or of a group"},
    {"node_at", "Add a node where it is seen", TRACING, "adds a node at what is seen at a pixel of a pane"},
    {"select_at", "Select what is seen", TRACING, "selects the node, internode or group at a pixel of a pane"},
    {"step_node", "Next node", TRACING, "selects the next node, or the one before, and looks at it"},
    {"mend_cut", "Mend the cut", TRACING, "links the nodes that deleting one between them has separated"},
    {"measure_at", "Measure", MEASURING, "sets one end of a distance at what is seen at a pixel of a pane"},
    {"clear_measurements", "Remove measurements", MEASURING, "removes all measured distances from the picture"},
    {"copy_measurements", "Copy measurements", MEASURING, "puts all measured distances onto the clipboard, as a table"},
    {"undo", "Undo", WORK, "takes the last steps of the history back"},
    {"redo", "Redo", WORK, "does the steps again that were undone last"},
    {"save", "Save", WORK, "writes mask, offsets, trace and session for other programs"},
    {"revert", "Revert", WORK, "goes back to what was saved last, as a step that undo takes back"},
    {"save_as", "Save as", WORK, "goes on under another name, with the whole history"},
    {"copy_session", "Copy the session", WORK, "writes all that is shown into files of another name"},
    {"export", "Export", WORK, "writes annotation in forms of other programs, and measures"},
    {"import", "Import as project", WORK, "makes a project folder of a volume, and opens it"},
    {"label", "Label connected parts", WORK, "counts connected parts above a threshold, and writes their labels"},
    {"evaluate", "Compare with a reference", WORK, "says how well an annotation agrees with another"},
    {"cancel_job", "Cancel", WORK, "ends a job that runs or waits"},
    {"screenshot", "Screenshot", WORK, "writes the picture as shown, or a larger one, beside the session"},
    {"open", "Open", WORK, "opens a volume, a session, a project folder or a picture"},
    {"look_at_file", "Look at a file", WORK, "reads what a file is, without its voxels, and what loading it takes"},
    {"take_file", "Take a file", WORK,
     "opens a file, or takes its annotation or transfer function, by its contents; of several into the one it opens"},
    {"correct_spacing", "Correct the spacing", WORK,
     "saves, and opens with another spacing; nodes stay at their voxels"},
    {"dismiss_notices", "Dismiss", WORK, "what was recovered or set aside at opening has been read"},
    {"forget_recent", "Forget", WORK, "takes a path from the list of what was opened last; the file stays"},
    {"choose_belief", "Files or journal", WORK, "says whether changed files or the journal are right"},
    {"work_on_copy", "Work on a copy", WORK, "saves all that is shown under new names, and opens that"},
    {"open_example", "Open the example", WORK, "opens the example that ships, in a copy that is kept for you"},
    {"ask_open", "Open...", WINDOW, "shows or hides the file chooser, which asks what to open"},
    {"choose_keys", "Choose the keys", WINDOW, "takes one of the two sets of keys that ship"},
    {"bind_keys", "Other keys", WINDOW, "gives a shortcut other keys than those that ship"},
    {"resize", "Resize", WINDOW, "the picture has so many pixels, across and down"},
    {"await_key", "Press a key for it", WINDOW, "the next key that is pressed is bound to a shortcut"},
    {"show_help", "Keys and mouse", WINDOW, "shows or hides the list of keys"},
    {"show_messages", "Messages", WINDOW, "shows or hides all that was said, and takes it as read"},
    {"show_passes", "GPU passes", WINDOW, "shows or hides what the device spends on each step of a picture"},
    {"save_passes", "Save GPU passes", WINDOW, "writes what the steps of the present picture took into a file"},
    {"compare_passes", "Compare GPU passes", WINDOW, "compares with such a file, or one of shvr profile --json"},
    {"show_palette", "Find anything", WINDOW, "shows or hides a box that finds shortcuts, actions and settings"},
    {"prefer", "Change preferences", WINDOW, "sets what a person keeps for all scans; null takes what ships"},
    {"show_preferences", "Preferences", WINDOW, "shows or hides theme, sizes and keys"},
    {"focus", "Use panels by keyboard", WINDOW, "gives the keyboard to the panels or to the menu"},
    {"full_screen", "Full screen", WINDOW, "the window takes the whole screen, or no longer"},
    {"quit", "Quit", WINDOW, "saves the work, or goes back to what was saved last, and closes the window"},
    {"let_go", "Let go", HAND, "no force at once, until it is switched off again"},
    {"grab_volume", "Take hold of the volume", HAND, "the volume moves and turns with the stylus until it is let go"},
    {"use_device", "Use a device", HAND, "takes a listed haptic device, or the first that can be used"},
    {"find_devices", "Look for devices", HAND, "looks again for what is plugged in"},
    {"calibrate_device", "Calibrate", HAND, "takes the stylus's place of rest as the origin"},
    {"record_stylus", "Record the stylus", HAND, "writes what the stylus does and feels, tick by tick, into a file"},
    {"stop_recording", "End the recording", HAND, "ends the recording of the stylus, and writes its file"},
    {"follow_stylus", "Follow a recorded stylus", HAND, "leads the probe along a recording, with the present guidance"},
};
static_assert(std::size(ROWS) == std::variant_size_v<Action>);

// ---- Arguments ------------------------------------------------------------------------------------------------------

const NumberRange DEGREES{-36000.0, 36000.0}, PIXELS{-1e6, 1e6}, FACTOR{1e-6, 1e6}, SHARES{-100.0, 100.0};
const NumberRange VOXELS{-1e12, 1e12}, DISTANCES{0.0, 1e15}, SPACINGS{1e-12, 1e12}, NODE_STEPS{0.5, 1000.0};

void pane_field(Fields& f, size_t& pane)
{
    f.whole("pane", pane, 0, 15, {"number of the pane, from 0"});
}

void pixel_field(Fields& f, const char* name, glm::dvec2& pixel)
{
    std::optional<glm::dvec2> value = pixel;
    f.numbers(name, value, PIXELS, {"pixels of the pane, right and down"});
    pixel = value.value_or(pixel);
}

void fields(Fields& f, Orbit& a)
{
    f.number("right_degrees", a.right_degrees, DEGREES, {});
    f.number("up_degrees", a.up_degrees, DEGREES, {});
}
void fields(Fields& f, Roll& a)
{
    f.number("degrees", a.degrees, DEGREES, {.is_required = true});
}
void fields(Fields& f, Move& a)
{
    f.vector("heights", a.heights, SHARES, {.is_required = true});
}
void fields(Fields& f, Zoom& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
    f.number("factor", a.factor, FACTOR, {.is_required = true});
}
void fields(Fields& f, FitView& a)
{
    pane_field(f, a.pane);
}
void fields(Fields& f, DragInMap& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixels", a.pixels);
}
void fields(Fields& f, LookFrom& a)
{
    f.text("camera", a.camera, {.is_required = true});
}
void fields(Fields& f, KeepCamera& a)
{
    f.text("name", a.name, {});
}
void fields(Fields& f, RenameCamera& a)
{
    f.text("name", a.name, {.is_required = true});
    f.text("to", a.to, {.is_required = true});
}
void fields(Fields& f, PivotAt& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
}
void fields(Fields& f, ForgetCamera& a)
{
    f.text("name", a.name, {.is_required = true});
}
void fields(Fields& f, MoveCut& a)
{
    f.whole("axis", a.axis, 0, 2, {.is_required = true});
    f.flag("upper", a.upper, {});
    f.number("share", a.share, SHARES, {.is_required = true});
}
void fields(Fields& f, MoveClip& a)
{
    f.flag("far", a.far, {});
    f.number("share", a.share, SHARES, {.is_required = true});
}
void fields(Fields& f, GoTo& a)
{
    f.vector("voxel", a.voxel, VOXELS, {.is_required = true});
}
void fields(Fields& f, PlaceClips& a)
{
    f.number("near", a.near, DISTANCES, {});
    f.number("far", a.far, DISTANCES, {});
}
void fields(Fields& f, KeepPreset& a)
{
    f.text("name", a.name, {.is_required = true});
}
void fields(Fields& f, RenamePreset& a)
{
    f.text("name", a.name, {.is_required = true});
    f.text("to", a.to, {.is_required = true});
}
void fields(Fields& f, ForgetPreset& a)
{
    f.text("name", a.name, {.is_required = true});
}
void fields(Fields& f, TakePreset& a)
{
    f.path("path", a.path, {.is_required = true});
}
void fields(Fields& f, ShowPasses& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, SavePasses& a)
{
    f.path("path", a.path, {.is_required = true});
}
void fields(Fields& f, ComparePasses& a)
{
    f.path("path", a.path, {});
}
void fields(Fields& f, Set& a)
{
    const auto read = [&](const JsonNode& node) {
        if (!node.is_object()) node.refuse("an object such as {\"light\": {\"ambient\": 0.4}}");
        a.patch = node.dump();
    };
    f.other("values", read, [&] { return std::optional(a.patch); }, {.is_required = true});
}
void fields(Fields& f, Prefer& a)
{
    const auto read = [&](const JsonNode& node) {
        if (!node.is_object()) node.refuse("an object such as {\"theme\": \"light\"}");
        a.patch = node.dump();
    };
    f.other("values", read, [&] { return std::optional(a.patch); }, {.is_required = true});
}
void fields(Fields& f, ShowPreferences& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, FocusOn& a)
{
    f.choice("what", a.what, {"panels", "menu"}, {});
}
void fields(Fields& f, ProbeTo& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
    f.flag("jumps", a.jumps, {});
}
void fields(Fields& f, ProbeAlong& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
    f.flag("jumps", a.jumps, {});
}
void fields(Fields& f, NodeAt& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
}
void fields(Fields& f, SelectAt& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
    f.flag("whole_segment", a.whole_segment, {});
}
void fields(Fields& f, StepNode& a)
{
    f.flag("back", a.back, {});
}
void fields(Fields& f, MeasureAt& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
}
void fields(Fields& f, ProbeOnto& a)
{
    pane_field(f, a.pane);
    pixel_field(f, "pixel", a.pixel);
}
void fields(Fields& f, PushProbe& a)
{
    pane_field(f, a.pane);
    f.number("voxels", a.voxels, VOXELS, {"away"});
    f.number("right", a.right, VOXELS, {});
    f.number("up", a.up, VOXELS, {});
}
void fields(Fields& f, PlaceProbe& a)
{
    f.vector("voxel", a.voxel, VOXELS, {.is_required = true});
    f.flag("jumps", a.jumps, {});
}
void fields(Fields& f, ScaleProbe& a)
{
    f.number("factor", a.factor, FACTOR, {.is_required = true});
}
void fields(Fields& f, Paint& a)
{
    f.flag("on", a.on, {.is_required = true});
}
void fields(Fields& f, DragNode& a)
{
    f.flag("on", a.on, {.is_required = true});
}
void fields(Fields& f, CancelJob& a)
{
    f.whole("number", a.number, 1, int64_t{1} << 53, {.is_required = true});
}
void fields(Fields& f, SaveAs& a)
{
    f.path("path", a.path, {.is_required = true});
}
void fields(Fields& f, CopySession& a)
{
    f.path("path", a.path, {});
}
void fields(Fields& f, Screenshot& a)
{
    f.flag("large", a.is_large, {});
}
void fields(Fields& f, Open& a)
{
    f.path("path", a.path, {.is_required = true});
    f.text("settings", a.settings, {"as --set takes them, one a line"});
}
void fields(Fields& f, LookAtFile& a)
{
    f.path("path", a.path, {});
    f.text("settings", a.settings, {"as --set takes them, one a line"});
}
void fields(Fields& f, TakeFile& a)
{
    f.path("path", a.path, {.is_required = true});
    f.text("beside", a.beside, {"what was dropped with it, one a line"});
}
void fields(Fields& f, CorrectSpacing& a)
{
    f.vector("spacing", a.spacing, SPACINGS, {.is_required = true});
    f.text("unit", a.unit, {"of the spacing; empty: as it is"});
}
void fields(Fields& f, ForgetRecent& a)
{
    f.path("path", a.path, {.is_required = true});
}
void fields(Fields& f, AskOpen& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, ChooseBelief& a)
{
    f.flag("files", a.takes_files, {.is_required = true});
}
void fields(Fields& f, ShowHelp& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, ShowMessages& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, ShowPalette& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, AwaitKey& a)
{
    f.text("shortcut", a.shortcut, {});
}
void fields(Fields& f, ChooseKeys& a)
{
    f.text("set", a.set, {.is_required = true});
}
void fields(Fields& f, BindKeys& a)
{
    f.text("shortcut", a.shortcut, {.is_required = true});
    f.text("keys", a.keys, {});
}
void fields(Fields& f, Resize& a)
{
    std::vector<int64_t> pixels{a.pixels.x, a.pixels.y};
    f.wholes("pixels", pixels, 0, 65536, {.is_required = true});
    a.pixels = {pixels[0], pixels[1]};
}
void fields(Fields& f, ShowFullScreen& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, Quit& a)
{
    f.flag("saves", a.saves, {});
}
void fields(Fields& f, LetGo& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, GrabVolume& a)
{
    f.flag("on", a.on, {});
}
void fields(Fields& f, UseDevice& a)
{
    f.text("device", a.device, {});
}
void fields(Fields& f, RecordStylus& a)
{
    f.path("path", a.path, {});
}
void fields(Fields& f, FollowStylus& a)
{
    f.path("path", a.path, {.is_required = true});
    f.flag("by_hand", a.by_hand, {});
    f.number("node_every_voxels", a.node_every_voxels, NODE_STEPS, {"between nodes, along x"});
}
template <class Bare>
requires std::is_empty_v<Bare>
void fields(Fields&, Bare&) {}

// ---- Between actions and lines --------------------------------------------------------------------------------------

template <class Kind>
constexpr bool IS_SCRIPT_OP = std::is_constructible_v<ScriptOp, Kind>;

/// The alternative of Action with that index, as it is made.
template <size_t INDEX = 0>
Action default_action(size_t index)
{
    if constexpr (INDEX + 1 < std::variant_size_v<Action>)
        if (index != INDEX) return default_action<INDEX + 1>(index);
    return Action(std::in_place_index<INDEX>);
}

/// The key that names the action, then its arguments.
Fields::Visit with_op(std::string& op, const Fields::Visit& arguments)
{
    return [&op, arguments](Fields& f) {
        f.text("op", op, {.is_required = true});
        arguments(f);
    };
}

/// ids of the registry and names of operations of scripts, each once.
std::vector<std::string_view> known_ids()
{
    std::vector<std::string_view> ids;
    for (const ActionRow& row : ROWS) ids.push_back(row.id);
    for (const std::string_view name : script_op_names())
        if (std::ranges::find(ids, name) == ids.end() && name != "expect") ids.push_back(name);
    return ids;
}

Action of_script(const ScriptOp& op, const JsonNode& line)
{
    return std::visit(
        [&]<class Op>(const Op& each) -> Action {
            if constexpr (std::is_constructible_v<Action, Op>)
                return each;
            else
                line["op"].refuse("an action");
        },
        op);
}

const JsonLimits LINE{.depth = 16, .expected = "an action"};

/// Splits at spaces that are not inside quotes.
std::vector<std::string> parts_of(const std::string& text)
{
    std::vector<std::string> words{""};
    bool is_quoted = false, is_escaped = false;
    for (const char c : text) {
        is_quoted ^= c == '"' && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        if (c == ' ' && !is_quoted)
            words.emplace_back();
        else
            words.back() += c;
    }
    std::erase(words, "");
    return words;
}

std::string quoted(const std::string& text)
{
    std::string escaped;
    for (const char c : text) escaped += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    return '"' + escaped + '"';
}

bool is_json(const std::string& text)
{
    try {
        return JsonDocument(text, "", LINE).root().exists();
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

std::span<const ActionRow> action_rows()
{
    return ROWS;
}

const ActionRow& row_of(const Action& action)
{
    return ROWS[action.index()];
}

std::string line_of(const Action& action)
{
    return std::visit(
        [&]<class Kind>(Kind kind) -> std::string {
            if constexpr (IS_SCRIPT_OP<Kind>) {
                return line_of(ScriptOp(kind));
            } else {
                std::string id = row_of(action).id;
                return write_fields({}, with_op(id, [&](Fields& f) { fields(f, kind); }));
            }
        },
        action);
}

Action read_action(const JsonNode& line)
{
    if (!line.is_object()) line.refuse("an object such as {\"op\":\"save\"}");
    const std::vector<std::string_view> ids = known_ids();
    std::string id(ids[line["op"].choice(ids)]);
    const auto names = script_op_names();
    if (std::ranges::find(names, id) != names.end()) return of_script(read_script_op(line), line);
    const auto row = std::ranges::find_if(ROWS, [&](const ActionRow& each) { return each.id == id; });
    Action action = default_action(size_t(row - std::begin(ROWS)));
    std::visit(
        [&]<class Kind>(Kind& kind) {
            if constexpr (!IS_SCRIPT_OP<Kind>) read_fields(line, {}, with_op(id, [&](Fields& f) { fields(f, kind); }));
        },
        action);
    return action;
}

Action read_action(std::string_view line, const std::string& origin)
{
    const JsonDocument document(line, origin, LINE);
    return read_action(document.root());
}

std::string text_of(const Action& action)
{
    const JsonDocument document(line_of(action), "action", LINE);
    std::string text = document.root()["op"].any_text();
    for (const std::string& key : document.root().names())
        if (key != "op") text += " " + key + "=" + document.root()[key].dump();
    return text;
}

Action action_of_text(const std::string& text)
{
    const std::vector<std::string> parts = parts_of(text);
    if (parts.empty()) fail("the action is empty; expected one such as: orbit right_degrees=3");
    std::string line = sentence("{\"op\":", quoted(parts.front()));
    for (const std::string& part : std::span(parts).subspan(1)) {
        const size_t equals = part.find('=');
        if (equals == std::string::npos || equals == 0)
            fail("action ", parts.front(), ": '", part, "' is no argument; expected key=value");
        const std::string value = part.substr(equals + 1);
        line += sentence(',', quoted(part.substr(0, equals)), ':', is_json(value) ? value : quoted(value));
    }
    return read_action(line + "}", "action");
}

}  // namespace shvr::ui
