#pragma once
// What the user asks for. Keys, mouse, menus and panels create actions and change nothing themselves; the application
// carries them out in one place, in order. Plain data; any thread.

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "engine/annotation/trace/trace_command.h"
#include "engine/session/session.h"
#include "haptics/proxy.h"

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
struct Zoom {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    double factor = 1.0;
};
/// Moves the camera in the plane of a map, following the mouse.
struct DragInMap {
    size_t pane = 0;
    glm::dvec2 pixels{0.0};
};
struct SetView {
    ViewSettings view;
};
struct LookFrom {
    std::string camera;  ///< a camera of the session, or a side
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
struct ResetCuts {};

// ---- Looks
struct SetTransferFunction {
    TransferFunction function;
};
struct SetGroup {
    uint8_t group = 1;
    GroupSettings settings;
};
struct SetBlend {
    DistanceBlend blend;
};
struct SetLight {
    Light light;
};
/// See RenderSettings; not used for steps longer than a voxel.
struct SetPreintegration {
    bool on = true;
};
struct SetOcclusion {
    OcclusionSettings occlusion;
};
struct UpdateOcclusion {};  ///< updates it where it does not update by itself

// ---- The probe
struct ProbeTo {  ///< follows the mouse in the plane through the probe
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};
struct ProbeOnto {  ///< onto the visible surface there
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};
struct PushProbe {  ///< away from the viewer of a pane, in voxels
    size_t pane = 0;
    double voxels = 0.0;
};
/// Limits of the probe's radius in the window, in voxels along x. Sessions and scripts may use other radii.
inline constexpr double SMALLEST_RADIUS_VOXELS = 0.5, LARGEST_RADIUS_VOXELS = 60.0;
struct ScaleProbe {
    double factor = 1.0;
};
/// Everything about the brush but its path and group: shape, radius, threshold, connectivity.
struct SetBrush {
    BrushSettings brush;
};
struct ShowShell {  ///< an iso-surface at the paint threshold around the probe
    bool on = true;
    double opacity = 0.4;
};
struct ShowPreview {  ///< what the brush would change, drawn beforehand
    bool on = true;
};
struct ChooseGroup {
    uint8_t group = 1;
};
enum class Tool { paint, trace };
/// A node counts as near the probe up to this distance, in radii of the probe.
inline constexpr double NEARBY_RADII = 4.0;
/// What the right mouse button, F and the stylus do, and which preview is shown.
struct SetTool {
    Tool tool = Tool::paint;
};
struct Paint {  ///< begins and ends a stroke; with the trace tool, its beginning adds a node
    bool on = false;
};
struct Trace {
    TraceOp op;
};
struct DragNode {  ///< the selected node follows the probe until released, as one step of the history
    bool on = false;
};
struct SetHapticThreshold {
    double intensity = 0.0;
};
struct Assist {
    bool on = false;
};
struct SetProxyLaw {
    ProxyLaw law = ProxyLaw::potential;
};

// ---- The work
struct Undo {};
struct Redo {};
struct Save {};
struct Screenshot {
    bool is_large = false;  ///< larger than the window, by the session's interaction.screenshot_scale
};
struct SetInteraction {
    InteractionSettings interaction;
};
struct Open {
    std::filesystem::path path;
};
/// Where another program has changed saved annotation: takes the files, as a step that undo takes back, or the journal.
struct ChooseBelief {
    bool takes_files = false;
};
/// Saves all that is shown under names of its own, and opens that.
struct WorkOnCopy {};
struct ShowHelp {
    bool on = true;
};
struct Quit {};

using Action = std::variant<Orbit, Roll, Move, Zoom, DragInMap, SetView, LookFrom, MoveCut, MoveClip, ResetCuts,
                            SetTransferFunction, SetGroup, SetLight, SetPreintegration, SetOcclusion, UpdateOcclusion,
                            SetBlend, ProbeTo, ProbeOnto, PushProbe, ScaleProbe, SetBrush, ShowShell, ShowPreview,
                            ChooseGroup, SetTool, Paint, Trace, DragNode, SetHapticThreshold, Assist, SetProxyLaw, Undo,
                            Redo, Save, Screenshot, SetInteraction, Open, ChooseBelief, WorkOnCopy, ShowHelp, Quit>;
using Actions = std::vector<Action>;

/// Whether it may change the session other than the camera and the probe's position.
inline bool edits_session(const Action& action)
{
    const auto is_one_of = [&]<class... Kinds>(const std::variant<Kinds...>*) {
        return (std::holds_alternative<Kinds>(action) || ...);
    };
    using Harmless = std::variant<Orbit, Roll, Move, Zoom, DragInMap, LookFrom, MoveClip, ProbeTo, ProbeOnto, PushProbe,
                                  UpdateOcclusion, Save, Screenshot, ChooseBelief, WorkOnCopy, ShowHelp, Quit>;
    return !is_one_of(static_cast<const Harmless*>(nullptr));
}

}  // namespace shvr::ui
