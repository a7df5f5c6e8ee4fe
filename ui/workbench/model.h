#pragma once
// A read-only view of the workbench, for panels, keys and conditions of actions. References and a few numbers: making
// one costs nothing worth measuring. Valid until the next action or turn.

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/work/work.h"
#include "engine/jobs/jobs.h"
#include "engine/live/screen.h"
#include "engine/session/choices.h"
#include "engine/session/session.h"
#include "engine/session/transfer_presets.h"
#include "haptics/servo.h"
#include "ui/workbench/messages.h"
#include "ui/workbench/sight/sight.h"

namespace shvr::ui {
struct HandView;
class Keymap;
class RecentActions;
struct PassRun;
struct Preferences;
}  // namespace shvr::ui

namespace shvr::ui {

/// A file that somebody thinks of opening (LookAtFile).
struct Candidate {
    std::filesystem::path path;
    std::string settings;  ///< with which it was looked at
    bool is_being_read = true;
    std::string failure;            ///< why it cannot be opened so; empty: it can, as far as that is known
    std::vector<Choice> choices{};  ///< where the reason is that one of several has to be chosen
    std::string kind;               ///< "Volume", "Session", "Project", "Picture of a session"
    bool is_project = false;        ///< nothing is to be imported
    VolumeInfo volume{};            ///< what follows is known only without a failure
    int levels = 1;
    std::string memory{};  ///< what it will take of host and device
    std::vector<std::string> warnings{};
};

struct Model {
    bool is_open = false;  ///< false: what follows is of an empty session
    const Session& session;
    const VolumeInfo& volume;
    const VolumeStatistics& statistics;
    const Camera& camera;
    const std::vector<Screen::Part>& panes;
    const std::vector<TransferPreset>& presets;
    const Screen* screen = nullptr;  ///< null where nothing is open

    // The probe
    glm::dvec3 probe_voxel{0.0};
    bool is_painting = false;                ///< a stroke is open, or not yet painted to its end
    bool stroke_is_open = false;             ///< the hand is down
    const ServoState* servo = nullptr;       ///< null while no servo runs
    glm::dvec3 tool_voxel{0.0};              ///< where tools act: the probe, or what it touches (FeelSettings)
    std::optional<uint32_t> tool_node;       ///< the node that they act at
    std::optional<uint32_t> tool_internode;  ///< the internode that they act on
    const HandView* hand = nullptr;          ///< devices and what the hand does; null where nothing is open

    std::optional<Pointer> pointer{};  ///< of the mouse, while it is over the picture
    Reading reading{};
    std::optional<glm::dvec3> picked_pivot{};  ///< volume space; what turning goes about, if the session says so

    // Measuring, in voxels
    std::span<const Measurement> measurements{};
    std::optional<glm::dvec3> measuring_from{};  ///< the first end of one that has no second yet
    std::optional<glm::dvec3> measuring_to{};    ///< where its second end would be now

    // Tracing
    const TraceGraph& trace;
    std::optional<uint32_t> nearby_node;  ///< near the probe, and not selected
    bool drags_node = false;
    bool is_cut = false;  ///< the last deletion cut the trace in two, and nothing has mended it
    /// Number of voxels that painting would change now; nothing if no preview is shown or it is still pending.
    std::optional<int64_t> previewed_voxels;

    // The work
    std::array<int64_t, 256> voxels_by_group{};
    const History* history = nullptr;   ///< null where nothing is open
    size_t undoable = 0, redoable = 0;  ///< a setting that is not a step of the history yet counts as undoable
    bool is_saved = true;
    bool is_saving = false;                    ///< files are being written; what is done meanwhile is not in them
    bool is_saving_as = false;                 ///< under another name: no command until that has ended
    bool has_session_file = false;             ///< false: a bare scan that was never saved
    std::span<const std::string> recovered{};  ///< what was recovered or set aside at opening, until it is dismissed
    std::string_view opening{};                ///< what is being opened; empty: nothing
    const Candidate* candidate = nullptr;      ///< null: none
    /// Why the last Open failed, and what it was to open; empty: it did not.
    std::string_view open_failure{};
    const std::filesystem::path* failed_path = nullptr;
    std::string_view holder{};  ///< who writes the project, if that is another process: then this window only looks
    const std::filesystem::path& session_path;
    std::span<const Dispute> disputes{};  ///< saved files that others have changed; empty: nothing to choose
    std::vector<Jobs::State> jobs{};      ///< the one that runs first
    const MessageLog& messages;
    const Keymap& keymap;
    const Preferences& preferences;
    const RecentActions* recent = nullptr;  ///< the last actions; null where nobody remembers them
    std::string_view version{};             ///< of the program
    bool shows_help = false, shows_messages = false, shows_passes = false, shows_palette = false,
         is_full_screen = false;
    bool asks_what_to_open = false, shows_preferences = false;
    std::string_view awaits_key{};  ///< id of the shortcut that the next key is for; empty: none

    // The device
    std::string_view gpu_name{};
    bool view_is_complete = true;
    bool view_is_limited = false;   ///< coarser than the screen, because the visible bricks exceed the budget
    double relevance_age_ms = 0.0;  ///< of the patch that the servo uses; 0 without assistance
    double ui_frame_ms = 0.0;       ///< median of the last frames; the window's
    uint64_t device_bytes = 0, device_budget = 0;
    std::map<std::string, uint64_t> bytes_by_name{};  ///< of what is on the device; only while the passes are shown
    const PassRun* compared_passes = nullptr;         ///< null: compared with nothing

    const BrushSettings& brush() const { return session.probe.brush; }
    double paint_threshold() const { return brush().threshold.value_or(0.0); }
    double haptic_threshold() const { return session.probe.haptic_threshold.value_or(0.0); }
    Tool tool() const { return session.probe.tool; }
    const std::string& status() const { return messages.last(); }
};

/// What the status bar says of files: a scan that nothing was ever saved of is no project that is "saved".
inline const char* saved_in_words(const Model& model)
{
    if (model.is_saving) return "saving";
    if (!model.is_saved) return "not saved";
    return model.has_session_file ? "saved" : "no project yet";
}

}  // namespace shvr::ui
