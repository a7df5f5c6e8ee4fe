#pragma once
// The application: a window on a workbench. It receives input, converts it to actions, and draws the state.
//
//   events -> Viewport, Keyboard, panels -> Actions -> Workbench -> View -> Window
//
// One thread (main). Brush, relevance, probe, sketch, tiles and user interface share the device's queue in slices of a
// few milliseconds. The interface is drawn when something has changed, but no more often than the session's frame rate;
// the loop sleeps while idle.

#include <atomic>
#include <memory>
#include <optional>

#include "engine/workbench/workbench.h"
#include "ui/keys.h"
#include "ui/panels/panels.h"
#include "ui/panels/style.h"
#include "ui/run_report.h"
#include "ui/viewport.h"

namespace shvr::ui {

struct AppOptions {
    std::string input;  ///< path of a session, project or volume; empty: opens the start page
    std::vector<std::string> settings;
    std::string device;
    gpu::Budget budget;
    int threads = 0;
    bool validation = false;
    const std::atomic<bool>* stop = nullptr;  ///< once true, the window closes as if its close button had been clicked
    bool saves_outside = false;               ///< sessions may write outside their folders without asking the user
    bool allow_force = false;                 ///< a haptic device with a verified profile may exert forces
    std::filesystem::path settings_folder{};  ///< folder of preferences and the user's transfer functions; empty: none
    std::filesystem::path log{};              ///< file that gets each action as a replayable line; empty: none
    std::filesystem::path screen_texts{};     ///< file that gets each frame's texts (screen_text.h); empty: none
    std::string version{};                    ///< version of the program, for reports
    glm::uvec2 window_size{1280, 800};
    bool keeps_place = true;  ///< the window begins where it was last, and its place is kept when it is closed
};

class App {
public:
    explicit App(const AppOptions& options);
    ~App();

    /// Runs the main loop; returns when the window is closed.
    void run();
    AppReport report();

private:
    void turn();
    void attach();
    void restart_device(const std::string& why);
    void handle_events(double timeout_s);
    void apply_all();
    void follow_workbench();
    void follow_appearance();
    void follow_focus();
    void leave_panels() const;
    void draw();
    bool draw_ui();
    void try_again_soon();
    void draw_strokes();
    void say_that_it_is_coming() const;
    void write_screen_texts() const;
    Model model() const;
    void keep_drawing(double for_s);
    bool something_moves() const;
    bool ui_has_mouse(const InputEvent& event) const;
    double next_reason_to_draw_s() const;
    double time_to_wait() const;
    bool ui_has_key(const KeyEvent& event) const;
    bool panels_have_keyboard() const;
    bool is_hidden() const;
    std::vector<InputEvent> events_in_turn(double timeout_s);
    void hold_back(std::vector<InputEvent>& events, size_t first);
    bool decides(const InputEvent& event, bool is_for_ui) const;
    bool closes();
    void begin_at_kept_place();
    void keep_place();
    bool refuses_to_close(const std::string& why);

    AppOptions options_;
    Window window_;
    std::unique_ptr<Renderer> renderer_;
    struct Detach {
        void operator()(Window* window) const { window->detach(); }
    };
    std::unique_ptr<Window, Detach> attached_;  ///< detaches the window from the device before the device is destroyed
    std::unique_ptr<Workbench> bench_;
    std::unique_ptr<std::ofstream> log_;
    Viewport viewport_;
    Keyboard keyboard_;
    Actions actions_;
    std::vector<InputEvent> held_back_;  ///< input for the frame after held_back_in_frame_
    int held_back_in_frame_ = -1;
    bool was_asked_to_close_ = false;  ///< closing was refused because saving failed; cleared by the next action
    /// Number of messages when the program was asked to stop from outside (AppOptions::stop); null: it was not.
    std::optional<uint64_t> messages_at_stop_;
    std::string frame_failure_;
    std::optional<double> undrawn_since_s_;  ///< time since which every frame has failed

    Appearance appearance_;
    uint64_t read_messages_ = 0;  ///< number of messages whose characters have been requested from the fonts

    // Pace
    double next_frame_s_ = 0.0;
    std::optional<double> undrawable_since_s_;  ///< time since which no image has been available; null: one is
    double ui_until_s_ = 1.0;                   ///< the interface is drawn at least until this time
    uint64_t ui_until_frame_ = 3;               ///< the interface is drawn at least until this frame is presented
    double last_keys_s_ = 0.0;
    uint64_t drawn_revision_ = ~uint64_t(0);
    bool drew_complete_ = false;  ///< whether the last drawn interface reports the picture as sharp
    bool drew_cut_box_ = false, drew_jobs_ = false, choosers_were_busy_ = false;
    uint64_t drawn_messages_ = 0, drawn_openings_ = 0;
    std::vector<LabelMemory> label_memories_;  ///< one per pane
    int drawn_windows_ = 0;                    ///< number of windows of the interface in the last frame
    glm::dvec3 drawn_probe_voxel_{0.0};
    RunReport report_;
};

}  // namespace shvr::ui
