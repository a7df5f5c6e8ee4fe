#pragma once
// What a person can ask for. Keys, mouse, menus, panels, the stylus and scripts make actions and change nothing; the
// workbench carries them out in one place, in order. Each has a stable id and arguments as JSON (action_rows.h), so it
// can be logged, replayed and written in a script. Plain data; any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/annotation/script/script.h"
#include "engine/session/session.h"
#include "engine/tasks/evaluate_task.h"
#include "engine/tasks/export_task.h"
#include "engine/tasks/import_task.h"
#include "engine/tasks/label_task.h"

namespace shvr::ui {

// ---- Looking. Angles in degrees; pixels are those of a pane, counted as in Screen::parts.
struct Orbit {
    double right_degrees = 0.0, up_degrees = 0.0;
};
struct Roll {
    double degrees = 0.0;
};
/// Along the camera's right, up and forward; 1 is the height of the view at the target's depth.
struct Move {
    glm::dvec3 heights{0.0};
};
struct Zoom {  ///< in a slice: all slices
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    double factor = 1.0;
};
/// Moves the camera in the plane of a map, or the slices, following the mouse.
struct DragInMap {
    size_t pane = 0;
    glm::dvec2 pixels{0.0};
};
struct LookFrom {
    std::string camera;  ///< a camera of the session, or a side
};
/// Keeps the present view under a name; a camera of that name is replaced. Without a name it gets a new one.
struct KeepCamera {
    std::string name;
};
struct ForgetCamera {
    std::string name;
};
struct RenameCamera {
    std::string name, to;
};
/// Turning goes about what is seen there, from now on.
struct PivotAt {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};
/// The camera looks at a voxel, from the same side and as far away as before.
struct GoTo {
    glm::dvec3 voxel{0.0};
};
/// Cutting planes: axis 0 ... 2, lower or upper plane, as fractions of the volume's size.
struct MoveCut {
    int axis = 0;
    bool upper = false;
    double share = 0.0;
};
/// Clip planes of the camera, as fractions of the distance to the target.
struct MoveClip {
    bool far = false;
    double share = 0.0;
};
/// Both clip planes, as distances from the eye in physical units; 0: no plane.
struct PlaceClips {
    double near = 0.0, far = 0.0;
};
struct ResetCuts {};
/// Brings the volume, or what the cutting planes leave of it, into sight, from where one looks.
struct FitView {
    size_t pane = 0;  ///< of a slice: all slices, instead of the camera
};
/// Back to the camera that the session opens with.
struct ResetView {};
/// Towards what is selected, at the distance there is.
struct LookAtSelection {};
struct UpdateOcclusion {};  ///< updates it where it does not update by itself

// ---- Settings
/// Any settings at once, as a patch of the session (session_patch.h). What lasts of them is a step of the history.
struct Set {
    std::string patch;
};

/// The first group that nothing uses yet becomes one of the session's, and the active one.
struct NewGroup {};

/// What was set since the last step becomes one; it does by itself when the hand lets go.
struct EndStep {};

// ---- A person's own transfer functions, kept for all scans (transfer_presets.h)
struct KeepPreset {
    std::string name;
};
struct RenamePreset {
    std::string name, to;
};
struct ForgetPreset {
    std::string name;
};
/// Takes the transfer function of a file, which need not be among those that are kept.
struct TakePreset {
    std::filesystem::path path;
};

// ---- The probe
struct ProbeTo {  ///< follows the mouse in the plane through the probe
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool jumps = false;  ///< not by the hand's motion: a stroke that is open paints nothing in between
};
/// Onto what is seen there: the largest rise of opacity along the ray (Renderer::pick).
struct ProbeOnto {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};
/// Follows the mouse along what is seen. While a stroke is open, its depth changes by no more than its radius and its
/// way across the picture, so that the stroke stays on the surface that it began on. Where nothing is seen, it keeps
/// its depth.
struct ProbeAlong {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool jumps = false;
};
struct PushProbe {  ///< away from the viewer of a pane, to the right and up, in voxels
    size_t pane = 0;
    double voxels = 0.0, right = 0.0, up = 0.0;
};
struct PlaceProbe {  ///< a stroke that is open goes there with it
    glm::dvec3 voxel{0.0};
    bool jumps = false;  ///< and paints nothing in between
};
/// Limits of the probe's radius in the window, in voxels along x. Sessions and scripts may use other radii.
inline constexpr double SMALLEST_RADIUS_VOXELS = 0.5, LARGEST_RADIUS_VOXELS = 60.0;
struct ScaleProbe {
    double factor = 1.0;
};

// ---- Painting and tracing. Strokes from scripts (PaintOp) and operations of the trace are actions, too.
struct Paint {  ///< begins and ends a stroke at the probe; with the trace tool, its beginning adds a node
    bool on = false;
};
/// A node counts as near the probe up to this distance, in radii of the probe.
inline constexpr double NEARBY_RADII = 4.0;
struct DragNode {  ///< the selected node follows the probe until released, as one step of the history
    bool on = false;
};
/// A node at what is seen there, linked with the selected one.
struct NodeAt {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};
/// Selects the node or internode that is seen there; or else takes the group that is painted there; or else selects
/// nothing.
struct SelectAt {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool whole_segment = false;
};
/// Selects the next node by number, and looks at it.
struct StepNode {
    bool back = false;
};
/// Links the two nodes between which the last deletion cut the trace.
struct MendCut {};

// ---- Measuring. Measurements are kept while the scan is open, and are no part of the work.
struct MeasureAt {  ///< one end at what is seen there; the second ends the measurement
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};
struct ClearMeasurements {};
struct CopyMeasurements {};  ///< all of them, as a table for the clipboard

/// Black and white of slices so that almost all voxels lie between them.
struct AutoContrast {};

// ---- The work
struct Screenshot {
    bool is_large = false;  ///< larger than the window, by the session's interaction.screenshot_scale
};
/// Goes on under another name, with the whole history; the files so far stay as they are.
struct SaveAs {
    std::filesystem::path path;  ///< of the session
};
/// Writes all that is shown into files of another name, and goes on as before. An empty path: beside the session.
struct CopySession {
    std::filesystem::path path;
};
/// Beside the work: what is open stays until the next is there.
struct Open {
    std::filesystem::path path;
    std::string settings{};  ///< for this time, as --set takes them: "volume.channel=red", one a line
};
/// Reads what a file is, without its voxels, for the dialog that opens it: Model::candidate.
struct LookAtFile {
    std::filesystem::path path;  ///< empty: none any more
    std::string settings{};      ///< as in Open
};
/// What was dropped onto the window: opens volumes, sessions, projects and pictures, and takes annotation and transfer
/// functions into what is open, as steps that undo takes back. What a file is, its contents say. Where one of several
/// can be opened, the others are taken into that.
struct TakeFile {
    std::filesystem::path path;
    std::string beside{};  ///< those that were dropped with it, one a line
};
/// The volume's spacing was wrong: saves the work, and opens it with this one. Positions stay at their voxels.
struct CorrectSpacing {
    glm::dvec3 spacing{1.0};
    std::string unit;
};
/// What was said of recovered work has been read.
struct DismissNotices {};
/// Exporting, importing, labelling and comparing are tasks (engine/tasks), each a job beside the work.
struct CancelJob {
    uint64_t number = 0;
};
/// Where another program has changed saved annotation: takes the files, as a step that undo takes back, or the journal.
struct ChooseBelief {
    bool takes_files = false;
};
/// Saves all that is shown under names of its own, and opens that.
struct WorkOnCopy {};
/// Opens the example that ships, as a copy of the person's own.
struct OpenExample {};

/// No longer among what was opened last; the file stays.
struct ForgetRecent {
    std::filesystem::path path;
};

// ---- The window
struct AskOpen {  ///< shows or hides the file chooser
    bool on = true;
};
/// The picture is so large now; what pixels of panes mean depends on it.
struct Resize {
    glm::uvec2 pixels{0};
};
struct ShowHelp {
    bool on = true;
};
/// All that was said, with its weight; while it is shown, all of it has been read.
struct ShowMessages {
    bool on = true;
};
/// What the device spends on each step of a picture.
struct ShowPasses {
    bool on = true;
};
/// Writes what the steps of the present picture took, to compare others with.
struct SavePasses {
    std::filesystem::path path;
};
/// Compares with such a file, or with what `shvr profile --json` printed; an empty path: with nothing any more.
struct ComparePasses {
    std::filesystem::path path;
};
/// A box to type in, which finds all shortcuts, actions and settings.
struct ShowPalette {
    bool on = true;
};
/// The next key that is pressed is bound to that shortcut; Escape leaves it as it is, Delete takes its keys away. An
/// empty id: none is waited for any more.
struct AwaitKey {
    std::string shortcut;
};
/// One of the two sets of keys (shortcuts.h).
struct ChooseKeys {
    std::string set;
};
/// Other keys for a shortcut: its id, and chords separated by spaces; none: it has no key.
struct BindKeys {
    std::string shortcut, keys;
};
/// Changes preferences (preferences.h), as a patch of their file: {"theme": "light"}; null takes what ships.
struct Prefer {
    std::string patch;
};
struct ShowPreferences {
    bool on = true;
};
/// Gives the keyboard to the panels or to the menu, until Escape or a click.
struct FocusOn {
    std::string what = "panels";  ///< or "menu"
};
struct ShowFullScreen {
    bool on = true;
};
struct Quit {
    bool saves = true;  ///< false: the work goes back to what was saved last, as a step that undo takes back
};

// ---- The hand. Devices are those of haptics/devices; what is chosen is kept for all scans.
struct LetGo {  ///< no force from the next tick on, until it is switched off again
    bool on = true;
};
struct GrabVolume {  ///< the volume moves and turns with the stylus until released; the probe stays on its voxel
    bool on = false;
};
struct UseDevice {
    std::string device;  ///< id of a listed one; empty: the first that can be used, whatever is plugged in
};
struct FindDevices {};      ///< looks again for what is plugged in
struct CalibrateDevice {};  ///< opens it anew, so that it takes its place of rest as its origin
/// What the stylus does and feels, tick by tick, into a file (haptics/replay/README.md).
struct RecordStylus {
    std::filesystem::path path;  ///< empty: a free name beside the session
};
struct StopRecording {};
/// Leads the probe along such a file, tick by tick, as a hand would with the present guidance: its first button paints,
/// or adds nodes in the trace tool.
struct FollowStylus {
    std::filesystem::path path;
    bool by_hand = true;             ///< a modelled hand holds a modelled stylus; false: the device's own answers
    double node_every_voxels = 8.0;  ///< between nodes, along x
};

using Action = std::variant<
    // looking
    Orbit, Roll, Move, Zoom, DragInMap, LookFrom, KeepCamera, ForgetCamera, RenameCamera, PivotAt, GoTo, MoveCut,
    MoveClip, PlaceClips, ResetCuts, FitView, ResetView, LookAtSelection, UpdateOcclusion,
    // settings, the probe
    Set, NewGroup, EndStep, AutoContrast, KeepPreset, RenamePreset, ForgetPreset, TakePreset, ProbeTo, ProbeOnto,
    ProbeAlong, PushProbe, PlaceProbe, ScaleProbe,
    // painting and tracing
    Paint, PaintOp, DragNode, NodeOp, SelectOp, SelectSegmentOp, DeselectOp, LinkOp, MoveOp, DeleteOp, GroupOp,
    RadiusOp, NodeAt, SelectAt, StepNode, MendCut,
    // measuring
    MeasureAt, ClearMeasurements, CopyMeasurements,
    // the work, the window
    UndoOp, RedoOp, SaveOp, RevertOp, SaveAs, CopySession, ExportTask, ImportTask, LabelTask, EvaluateTask, CancelJob,
    Screenshot, Open, LookAtFile, TakeFile, CorrectSpacing, DismissNotices, ForgetRecent, ChooseBelief, WorkOnCopy,
    OpenExample, AskOpen, ChooseKeys, BindKeys, Resize, AwaitKey, ShowHelp, ShowMessages, ShowPasses, SavePasses,
    ComparePasses, ShowPalette, Prefer, ShowPreferences, FocusOn, ShowFullScreen, Quit,
    // the hand
    LetGo, GrabVolume, UseDevice, FindDevices, CalibrateDevice, RecordStylus, StopRecording, FollowStylus>;
using Actions = std::vector<Action>;

}  // namespace shvr::ui
