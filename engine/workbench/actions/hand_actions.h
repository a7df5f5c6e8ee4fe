#pragma once
// Actions on the haptic device ("the hand"); haptics/devices lists the devices. The chosen device applies to all scans.

#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Hand;

struct LetGo {  ///< switches forces off from the servo's next tick until they are switched on again
    bool on = true;
};

struct GrabVolume {  ///< moves and rotates the volume with the stylus until released; the probe stays on its voxel
    bool on = false;
};

struct UseDevice {
    std::string device;  ///< id of a listed device; empty: the first usable one
};

struct FindDevices {};  ///< searches for connected devices again

struct CalibrateDevice {};  ///< reopens the device, so that its rest position becomes the origin

/// Records the stylus's motion and forces, tick by tick, to a file (haptics/replay/README.md).
struct RecordStylus {
    std::filesystem::path path;  ///< empty: chooses an unused name next to the session
};

struct StopRecording {};

/// Moves the probe along a recorded path, tick by tick, guided by the current settings. While the recording's first
/// button is down, the probe paints or, with the trace tool, adds nodes.
struct FollowStylus {
    std::filesystem::path path;
    bool by_hand = true;             ///< simulates a hand with a stylus; false: replays the device's recorded responses
    double node_every_voxels = 8.0;  ///< distance between nodes, along x
};

inline constexpr const char* HAND_GROUP = "Touch";

inline constexpr auto HAND_ACTIONS = std::tuple{
    row<LetGo, Hand>({"let_go", "Let go", HAND_GROUP, "switches all force off at once, or allows it again"},
                     [](auto& f, LetGo& a) { f.flag("on", a.on, {}); }),
    row<GrabVolume, Hand>(
        {"grab_volume", "Take hold of the volume", HAND_GROUP,
         "moves and turns the volume with the stylus until released"},
        [](auto& f, GrabVolume& a) { f.flag("on", a.on, {}); },
        [](const auto& model, const GrabVolume& action) -> std::string {
            return !action.on || (model.hand && model.hand->moves_probe) ? "" : "no stylus moves the probe";
        }),
    row<UseDevice, Hand>(
        {"use_device", "Use a device", HAND_GROUP, "uses a listed haptic device, or the first usable one"},
        [](auto& f, UseDevice& a) { f.text("device", a.device, {}); },
        [](const auto& model, const UseDevice& action) -> std::string {
            if (action.device.empty()) return {};
            const auto is_it = [&](const auto& device) { return device.id == action.device; };
            const bool is_there = model.hand && std::ranges::any_of(model.hand->devices, is_it);
            return is_there ? "" : sentence("no device ", action.device, " is plugged in");
        }),
    row<FindDevices, Hand>({"find_devices", "Look for devices", HAND_GROUP, "searches for connected devices again"}),
    row<CalibrateDevice, Hand>(
        {"calibrate_device", "Calibrate", HAND_GROUP, "sets the origin to the stylus's rest position"}, NO_FIELDS,
        [](const auto& model, const CalibrateDevice&) -> std::string {
            return model.hand && model.hand->moves_probe ? "" : "no haptic device moves the probe";
        }),
    row<RecordStylus, Hand>(
        {"record_stylus", "Record the stylus", HAND_GROUP,
         "records motion and forces of the stylus, tick by tick, to a file"},
        [](auto& f, RecordStylus& a) { f.path("path", a.path, {}); },
        [](const auto& model, const RecordStylus&) -> std::string {
            return model.hand && model.hand->recorded_s ? "the stylus is being recorded" : "";
        }),
    row<StopRecording, Hand>(
        {"stop_recording", "End the recording", HAND_GROUP, "ends the recording of the stylus, and writes its file"},
        NO_FIELDS,
        [](const auto& model, const StopRecording&) -> std::string {
            return model.hand && model.hand->recorded_s ? "" : "nothing is being recorded";
        }),
    row<FollowStylus, Hand>(
        {"follow_stylus", "Follow a recorded stylus", HAND_GROUP,
         "moves the probe along a recording, with the present guidance"},
        [](auto& f, FollowStylus& a) {
            f.path("path", a.path, {.is_required = true});
            f.flag("by_hand", a.by_hand, {});
            f.number("node_every_voxels", a.node_every_voxels, NODE_STEPS, {"between nodes, along x"});
        },
        [](const auto& model, const FollowStylus&) -> std::string {
            return model.is_painting ? IS_PAINTING : why_not_edited(model);
        })};

}  // namespace shvr::ui
