#pragma once
// The application: a window on a workbench. It receives input, turns it into actions, and draws what there is to see.
//
//   events -> Viewport, Keyboard, panels -> Actions -> Workbench -> View -> Window
//
// One thread (main). Brush, relevance, probe, sketch, tiles and user interface share the device's queue in turns of a
// few milliseconds. The interface is drawn when something changed, at most at the session's frame rate; with nothing to
// do the loop sleeps.

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
    std::string input;  ///< session, project or volume; empty: nothing is open
    std::vector<std::string> settings;
    std::string device;
    gpu::Budget budget;
    int threads = 0;
    bool validation = false;
    const std::atomic<bool>* stop = nullptr;  ///< once it is true, the window is asked to close, as by its button
    bool allow_force = false;                 ///< lets a haptic device with a verified profile push the hand
    std::filesystem::path preferences{};      ///< the file (workbench/preferences.h); empty: none are read or kept
    std::filesystem::path log{};              ///< each action is written there as a line that replays it; empty: none
    std::filesystem::path screen_texts{};     ///< each frame's texts are written there (screen_text.h); empty: none
    std::string version{};                    ///< of the program, for reports
    glm::uvec2 window_size{1280, 800};
};

class App {
public:
    explicit App(const AppOptions& options);
    ~App();

    /// Returns when the window is closed.
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
    void draw_strokes() const;
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
    std::vector<InputEvent> events_in_turn(double timeout_s);
    void hold_back(std::vector<InputEvent>& events, size_t first);
    bool decides_who_has_keys(const KeyEvent& event, bool is_for_ui) const;
    bool closes();
    bool refuses_to_close(const std::string& why);

    AppOptions options_;
    Window window_;
    std::unique_ptr<Renderer> renderer_;
    struct Detach {
        void operator()(Window* window) const { window->detach(); }
    };
    std::unique_ptr<Window, Detach> attached_;  ///< detaches the window before the device is destroyed
    std::unique_ptr<Workbench> bench_;
    std::unique_ptr<std::ofstream> log_;
    Viewport viewport_;
    Keyboard keyboard_;
    Actions actions_;
    std::vector<InputEvent> held_back_;  ///< until a frame after this one:
    int held_back_in_frame_ = -1;
    bool was_asked_to_close_ = false;  ///< and could not save everything; nothing was done since
    bool was_stopped_ = false;         ///< from outside (AppOptions::stop)
    std::string frame_failure_;
    std::optional<double> undrawn_since_s_;  ///< every frame has failed since then

    Appearance appearance_;
    uint64_t read_messages_ = 0;  ///< whose characters the fonts have

    // Pace
    double next_frame_s_ = 0.0;
    std::optional<double> undrawable_since_s_;  ///< there has been no image to draw in since then, or the last was lost
    double ui_until_s_ = 1.0;                   ///< the interface is drawn at least until then
    uint64_t ui_until_frame_ = 3;               ///< and until so many frames are presented
    double last_keys_s_ = 0.0;
    uint64_t drawn_revision_ = ~uint64_t(0);
    bool drew_complete_ = false;  ///< the interface says whether the picture is sharp
    bool drew_cut_box_ = false;
    uint64_t drawn_messages_ = 0, drawn_openings_ = 0;
    glm::dvec3 drawn_probe_voxel_{0.0};
    RunReport report_;
};

}  // namespace shvr::ui
