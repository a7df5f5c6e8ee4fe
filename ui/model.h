#pragma once
// A read-only view of the application's state in this frame, for panels and keys. Plain references and numbers; the
// application fills it once per frame.

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/trace/trace_command.h"
#include "engine/live/annotator.h"
#include "engine/live/screen.h"
#include "engine/session/session.h"
#include "engine/session/transfer_presets.h"
#include "haptics/servo.h"
#include "ui/action.h"

namespace shvr::ui {

struct Model {
    const Session& session;
    const VolumeInfo& volume;
    const VolumeStatistics& statistics;
    std::vector<std::string> cameras;  ///< names that LookFrom takes

    const std::vector<Screen::Part>& panes;
    const std::vector<TransferPreset>& presets;

    // The probe
    const PaintOp& brush;  ///< the group it paints, its radius, its threshold
    double haptic_threshold = 0.0;
    glm::dvec3 probe_voxel{0.0};
    bool is_painting = false;
    bool assistance = false;
    ProxyLaw law = ProxyLaw::potential;
    const ServoState* servo = nullptr;  ///< null while no servo runs
    std::string device_name;            ///< device that moves the probe: "mouse", ...

    // Tracing
    Tool tool = Tool::paint;
    const TraceGraph& trace;
    std::optional<uint32_t> nearby_node;  ///< near the probe, and not selected
    /// Number of voxels that painting would change now; nothing if no preview is shown or it is still pending.
    std::optional<int64_t> previewed_voxels;

    // The work
    std::array<int64_t, 256> voxels_by_group{};
    size_t undoable = 0, redoable = 0;
    bool is_saved = true;
    std::string holder;  ///< who writes the project, if that is another process: then this window only looks
    std::filesystem::path session_path{};
    std::span<const Dispute> disputes{};  ///< saved files that others have changed; empty: nothing to choose
    std::string status;                   ///< the last action, in words
    bool shows_help = false;

    // The device
    std::string gpu_name;
    std::vector<View::PassTime> pass_times;
    bool view_is_complete = true;
    bool view_is_limited = false;   ///< coarser than the screen, because the visible bricks exceed the budget
    double relevance_age_ms = 0.0;  ///< of the patch that the servo uses; 0 without assistance
    double ui_frame_ms = 0.0;       ///< median of the last frames
    uint64_t device_bytes = 0, device_budget = 0;
};

}  // namespace shvr::ui
