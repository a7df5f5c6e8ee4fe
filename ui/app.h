#pragma once
// The application: owns the window, the device and the open document; receives input, carries out actions, and keeps
// everything that runs beside the user interface supplied with work.
//
//   events -> Viewport, keys, panels -> Actions -> apply -> Session, Annotator, Touch -> View -> Window
//
// Threads: this one (main), the servo's while assistance is on, and one that writes a screenshot. Brush, relevance,
// probe, sketch, tiles and user interface share the device's queue in turns of a few milliseconds. The interface is
// drawn when something changed, at most at the session's frame rate; with nothing to do the loop sleeps.

#include <atomic>
#include <memory>
#include <optional>

#include "ui/document.h"
#include "ui/panels/panels.h"
#include "ui/run_report.h"
#include "ui/screenshots.h"
#include "ui/viewport.h"

namespace shvr::ui {

struct AppOptions {
    std::string input;  ///< session, project or volume; empty: nothing is open
    std::vector<std::string> settings;
    std::string device;
    gpu::Budget budget;
    int threads = 0;
    bool validation = false;
    const std::atomic<bool>* stop = nullptr;  ///< once it is true, the window is asked to close, as by its button
    bool allow_force = false;                 ///< lets a haptic device with a verified profile push the hand
    glm::uvec2 window_size{1280, 800};
};

class App {
public:
    explicit App(const AppOptions& options);

    /// Returns when the window is closed.
    void run();
    AppReport report();

private:
    void open(const std::filesystem::path& path, const std::vector<std::string>& settings);
    [[noreturn]] void bring_back(const std::string& why);
    void note_edit();
    void follow_settings();
    void record_settings();
    std::unique_ptr<HapticDevice> find_device(std::string& said) const;
    void handle_events(double timeout_s);
    void work();
    void draw_ui();
    void draw_strokes() const;
    Model model();
    bool something_moves() const;
    double next_reason_to_draw_s() const;
    double time_to_wait() const;
    void apply_all();
    void say(const std::string& status);
    /// A part of a turn. A failure is reported once, and the part is retried a little later: whatever fails, the window
    /// stays open and no work is lost.
    struct Attempt {
        std::string said;       ///< message of the last failure
        double failed_s = 0.0;  ///< when that was; 0: never
        double again_s = 0.0;
    };
    template <class Part>
    void attempt(Attempt& state, Part part);
    void note_failure(Attempt& state, const std::string& why);
    void draw();
    void look_again() { look_is_stale_ = true; }
    void look_from_elsewhere() { camera_moved_ = true; }
    const Pane& pane(size_t index) const;
    TouchSettings touch_settings() const;
    void follow_device();
    void follow_stroke();
    void follow_look();
    std::filesystem::path screenshot_stem() const;
    void follow_screenshots();
    void extend_stroke();
    std::string finish_stroke();
    void show_changes(const Command& command);
    void stroke_ended();
    void show_preview();
    void save();
    void save_before_leaving();
    bool closes();
    bool refuses_to_close(const std::string& why);

    // One for each action.
    void apply(const Orbit& action);
    void apply(const Roll& action);
    void apply(const Move& action);
    void apply(const Zoom& action);
    void apply(const DragInMap& action);
    void apply(const SetView& action);
    void apply(const LookFrom& action);
    void apply(const MoveCut& action);
    void apply(const MoveClip& action);
    void apply(const ResetCuts& action);
    void apply(const SetTransferFunction& action);
    void apply(const SetGroup& action);
    void apply(const SetLight& action);
    void apply(const SetPreintegration& action);
    void apply(const SetBlend& action);
    void apply(const SetOcclusion& action);
    void apply(const UpdateOcclusion& action);
    void apply(const ProbeTo& action);
    void apply(const ProbeOnto& action);
    void apply(const PushProbe& action);
    void apply(const ScaleProbe& action);
    void apply(const SetBrush& action);
    void apply(const ShowShell& action);
    void apply(const ShowPreview& action);
    void apply(const ChooseGroup& action);
    void apply(const SetTool& action);
    void apply(const Paint& action);
    void apply(const Trace& action);
    void apply(const DragNode& action);
    void apply(const SetHapticThreshold& action);
    void apply(const Assist& action);
    void apply(const SetProxyLaw& action);
    void apply(const Undo& action);
    void apply(const Redo& action);
    void apply(const Save& action);
    void apply(const Screenshot& action);
    void apply(const SetInteraction& action);
    void apply(const Open& action);
    void apply(const ChooseBelief& action);
    void apply(const WorkOnCopy& action);
    void apply(const ShowHelp& action);
    void apply(const Quit& action);

    AppOptions options_;
    Window window_;
    std::unique_ptr<Renderer> renderer_;
    struct Detach {
        void operator()(Window* window) const { window->detach(); }
    };
    std::unique_ptr<Window, Detach> attached_;  ///< detaches the window before the device is destroyed
    std::unique_ptr<Document> document_;
    Viewport viewport_;
    std::vector<TransferPreset> presets_;
    Actions actions_;
    bool shows_help_ = false;
    bool look_is_stale_ = true;
    bool camera_moved_ = false;
    bool settings_to_record_ = false, was_set_in_this_turn_ = false;
    bool was_asked_to_close_ = false;  ///< and could not save everything; nothing was done since
    bool was_stopped_ = false;         ///< from outside (AppOptions::stop)
    Attempt events_, touching_, recording_, painting_, previewing_, looking_, photographing_, drawing_;
    std::optional<double> undrawn_since_s_;  ///< every frame has failed since then
    Screenshots screenshots_;
    bool device_paints_ = false;  ///< its paint button is down
    std::string status_;
    std::string journal_failure_;  ///< as last reported

    // Pace
    double next_frame_s_ = 0.0;
    double ui_until_s_ = 1.0;  ///< the interface is drawn at least until then
    double last_keys_s_ = 0.0;
    uint64_t drawn_revision_ = ~uint64_t(0);
    glm::dvec3 drawn_probe_voxel_{0.0};
    RunReport report_;
};

}  // namespace shvr::ui
