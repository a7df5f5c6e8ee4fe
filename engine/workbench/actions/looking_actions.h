#pragma once
// Actions on the view. Angles are in degrees; pixels are pixels of a pane, and panes are numbered as in Screen::parts.

#include "engine/base/spelling.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Viewer;

struct Orbit {
    double right_degrees = 0.0, up_degrees = 0.0;
};

struct Roll {
    double degrees = 0.0;
};

/// Moves the camera along its right, up and forward axes. Unit of length: the height of the view at the target's depth.
struct Move {
    glm::dvec3 heights{0.0};
};

struct Zoom {  ///< in a slice: all slices
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    double factor = 1.0;
};

/// Carries out a mouse drag in a map: moves the camera in the overview's plane or, if the map is a slice, the slices.
struct DragInMap {
    size_t pane = 0;
    glm::dvec2 pixels{0.0};
};

struct LookFrom {
    std::string camera;      ///< name of one of the session's cameras, or of a side of the volume
    bool with_look = false;  ///< also shows the look that was kept with the camera
};

/// Stores the current view as a camera of the session, replacing a camera of this name. Empty: chooses an unused name.
struct KeepCamera {
    std::string name;
    bool with_look = false;  ///< also stores what movies mix (KeyLook)
};

struct ForgetCamera {
    std::string name;
};

struct RenameCamera {
    std::string name, to;
};

/// Sets the pivot of rotations to the visible point at a pixel.
struct PivotAt {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};

/// Moves the camera to look at a voxel, from the current direction and distance.
struct GoTo {
    glm::dvec3 voxel{0.0};
};

/// Moves a cutting plane (axis 0 ... 2, lower or upper plane) by a fraction of the volume's size.
struct MoveCut {
    int axis = 0;
    bool upper = false;
    double share = 0.0;
};

/// Moves a clip plane of the camera, by a fraction of the distance to the target.
struct MoveClip {
    bool far = false;
    double share = 0.0;
};

/// Sets both clip planes, as distances from the eye in physical units; 0: no plane.
struct PlaceClips {
    double near = 0.0, far = 0.0;
};

/// What becomes of the oblique cutting plane.
enum class PlaneChange { add, flip, remove };
inline constexpr Spelling<PlaneChange> PLANE_CHANGES[] = {
    {PlaneChange::add, "add"}, {PlaneChange::flip, "flip"}, {PlaneChange::remove, "remove"}};
constexpr std::span<const Spelling<PlaneChange>> spellings_of(PlaneChange)
{
    return PLANE_CHANGES;
}

/// Adds an oblique cutting plane through the middle of the view, facing the camera, or turns the present one there;
/// flips it, so that it removes the other side; or removes it.
struct CutObliquely {
    PlaneChange change = PlaneChange::add;
};

struct ResetCuts {};

/// Fits the volume, or the part of it within the cutting planes, into the view without rotating the camera.
struct FitView {
    size_t pane = 0;  ///< if this pane shows a slice, all slices are fitted and the camera stays unchanged
};

/// Restores the view with which the session opens.
struct ResetView {};

/// Points the camera at the selected part of the trace, from the current distance.
struct LookAtSelection {};

struct UpdateOcclusion {};  ///< computes ambient occlusion now, for use while automatic updates are off

inline constexpr const char* LOOKING_GROUP = "Looking";

/// Lines state it only where it is true.
template <class Visitor>
void look_flag(Visitor& f, bool& with_look)
{
    std::optional<bool> flag = with_look ? std::optional(true) : std::nullopt;
    f.any_flag("with_look", flag, {"the transfer function, groups, light, blending and cut, too"});
    with_look = flag.value_or(false);
}

inline constexpr auto LOOKING_ACTIONS = std::tuple{
    row<Orbit, Viewer>(
        {"orbit", "Turn the view", LOOKING_GROUP, "turns the camera about its target, to the right and up"},
        [](auto& f, Orbit& a) {
            f.number("right_degrees", a.right_degrees, DEGREES, {});
            f.number("up_degrees", a.up_degrees, DEGREES, {});
        }),
    row<Roll, Viewer>({"roll", "Roll the view", LOOKING_GROUP, "turns the camera about its line of sight"},
                      [](auto& f, Roll& a) { f.number("degrees", a.degrees, DEGREES, {.is_required = true}); }),
    row<Move, Viewer>(
        {"move_view", "Move the view", LOOKING_GROUP, "moves the camera right, up and forward, in heights of the view"},
        [](auto& f, Move& a) { f.vector("heights", a.heights, SHARES, {.is_required = true}); }),
    row<Zoom, Viewer>({"zoom", "Zoom", LOOKING_GROUP,
                       "brings what lies under a pixel of a pane nearer by a factor; in a slice, all slices"},
                      [](auto& f, Zoom& a) {
                          pane_field(f, a.pane);
                          pixel_field(f, "pixel", a.pixel);
                          f.number("factor", a.factor, FACTOR, {.is_required = true});
                      }),
    row<DragInMap, Viewer>({"drag_in_map", "Move the camera in a map", LOOKING_GROUP,
                            "moves the camera with the mouse in a map, or the slices"},
                           [](auto& f, DragInMap& a) {
                               pane_field(f, a.pane);
                               pixel_field(f, "pixels", a.pixels);
                           }),
    row<LookFrom, Viewer>(
        {"look_from", "Look from", LOOKING_GROUP,
         "takes a camera of the session, or a side of the volume; on request with the look that was kept with it"},
        [](auto& f, LookFrom& a) {
            f.text("camera", a.camera, {.is_required = true});
            look_flag(f, a.with_look);
        },
        [](const auto& model, const LookFrom& action) -> std::string {
            return !action.with_look || model.session.key_looks.contains(action.camera)
                       ? ""
                       : sentence("no look is kept with the view ", action.camera);
        }),
    row<KeepCamera, Viewer>(
        {"keep_camera", "Keep this view", LOOKING_GROUP,
         "keeps the present view in the session, under a name; on request with its look, which movies mix"},
        [](auto& f, KeepCamera& a) {
            f.text("name", a.name, {});
            look_flag(f, a.with_look);
        }),
    row<ForgetCamera, Viewer>(
        {"forget_camera", "Forget a view", LOOKING_GROUP, "removes a camera of the session"},
        [](auto& f, ForgetCamera& a) { f.text("name", a.name, {.is_required = true}); },
        [](const auto& model, const ForgetCamera& action) -> std::string {
            return model.session.cameras.contains(action.name) ? "" : sentence("no view is kept as ", action.name);
        }),
    row<RenameCamera, Viewer>(
        {"rename_camera", "Rename a view", LOOKING_GROUP, "renames a camera of the session"},
        [](auto& f, RenameCamera& a) {
            f.text("name", a.name, {.is_required = true});
            f.text("to", a.to, {.is_required = true});
        },
        [](const auto& model, const RenameCamera& action) -> std::string {
            if (!model.session.cameras.contains(action.name)) return sentence("no view is kept as ", action.name);
            return model.session.cameras.contains(action.to) ? sentence("a view is kept as ", action.to, " already")
                                                             : "";
        }),
    row<PivotAt, Viewer>(
        {"pivot_at", "Set pivot here", LOOKING_GROUP, "sets the pivot to the point seen at a pixel of a pane"},
        [](auto& f, PivotAt& a) {
            pane_field(f, a.pane);
            pixel_field(f, "pixel", a.pixel);
        }),
    row<GoTo, Viewer>(
        {"go_to", "Go to", LOOKING_GROUP, "points the camera at a voxel, from the same side and distance"},
        [](auto& f, GoTo& a) { f.vector("voxel", a.voxel, VOXELS, {.is_required = true}); }),
    row<MoveCut, Viewer>({"move_cut", "Move a cutting plane", LOOKING_GROUP,
                          "moves one of the six planes by a share of the volume's size"},
                         [](auto& f, MoveCut& a) {
                             f.whole("axis", a.axis, 0, 2, {.is_required = true});
                             f.flag("upper", a.upper, {});
                             f.number("share", a.share, SHARES, {.is_required = true});
                         }),
    row<MoveClip, Viewer>({"move_clip", "Move a clip plane", LOOKING_GROUP,
                           "moves the near or far plane by a share of the distance to the target"},
                          [](auto& f, MoveClip& a) {
                              f.flag("far", a.far, {});
                              f.number("share", a.share, SHARES, {.is_required = true});
                          }),
    row<PlaceClips, Viewer>({"place_clips", "Place the clip planes", LOOKING_GROUP,
                             "puts the near and the far plane at distances from the eye"},
                            [](auto& f, PlaceClips& a) {
                                f.number("near", a.near, DISTANCES, {});
                                f.number("far", a.far, DISTANCES, {});
                            }),
    row<CutObliquely, Viewer>(
        {"oblique_cut", "Oblique cutting plane", LOOKING_GROUP,
         "adds a cutting plane through the middle of the view, facing the camera, or turns the present one there; "
         "flips "
         "it, so that it removes the other side; or removes it"},
        [](auto& f, CutObliquely& a) { f.choice("change", a.change, {.is_required = true}); },
        [](const auto& model, const CutObliquely& action) -> std::string {
            return action.change == PlaneChange::add || model.session.cut.plane_normal
                       ? ""
                       : "there is no oblique cutting plane";
        }),
    row<ResetCuts, Viewer>({"reset_cuts", "Remove all planes", LOOKING_GROUP, "shows the whole volume"}),
    row<FitView, Viewer>(
        {"fit_view", "Fit", LOOKING_GROUP, "brings the uncut part of the volume into view; in a slice, the slices"},
        [](auto& f, FitView& a) { pane_field(f, a.pane); }),
    row<ResetView, Viewer>(
        {"reset_view", "Reset the view", LOOKING_GROUP, "restores the camera that the session opens with"}),
    row<LookAtSelection, Viewer>(
        {"look_at_selection", "Look at the selection", LOOKING_GROUP, "centres the selection in the view"}, NO_FIELDS,
        [](const auto& model, const LookAtSelection&) -> std::string {
            return model.trace.selection().empty() ? "nothing is selected" : "";
        }),
    row<UpdateOcclusion, Viewer>({"update_occlusion", "Update ambient occlusion", LOOKING_GROUP,
                                  "recomputes ambient occlusion if that is not automatic"},
                                 NO_FIELDS, [](const auto& model, const UpdateOcclusion&) -> std::string {
                                     return model.session.light.occlusion.strength > 0.0
                                                ? ""
                                                : "ambient occlusion is off: its strength is 0";
                                 })};

}  // namespace shvr::ui
