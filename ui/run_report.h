#pragma once
// Measures a run: duration of interface frames, latency of keys and first pictures, and the messages shown. Times are
// seconds of the window's clock. Main thread only.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "haptics/servo.h"

namespace shvr::ui {

/// Measurements of a run of the application, for profiling and tests.
struct AppReport {
    std::string gpu_name;
    uint64_t frames = 0;           ///< number of frames of the user interface
    std::vector<double> frame_ms;  ///< durations of interface frames, from the first call until the device has finished
    /// frame_ms without the wait for running work on a software device. `own_idle_ms`: frames drawn while no picture is
    /// being refined; `own_busy_ms`: frames drawn while a picture is being refined.
    std::vector<double> own_idle_ms, own_busy_ms;
    std::vector<double> interval_ms;  ///< time between two frames while something was moving
    std::vector<double> input_ms;     ///< time from a press until the frame with its effect is finished
    /// Time from opening the last volume until the device has finished two frames:
    /// the first frame that shows any part of the volume (first_picture_ms),
    /// and the first frame that shows all of the picture sharp (sharp_picture_ms).
    std::optional<double> first_picture_ms, sharp_picture_ms;
    std::vector<double> relevance_ms;  ///< latencies from requesting relevance until the servo has it
    uint64_t view_submissions = 0;
    bool view_complete = false;
    ServoState servo;
    glm::dvec3 probe_voxel{0.0};
    std::array<int64_t, 256> voxels_by_group{};
    size_t undoable = 0, redoable = 0;
    std::optional<int64_t> previewed_voxels;  ///< size of the preview at the start of the last stroke; null: none
    std::string status;
    std::vector<std::string> messages;     ///< last messages
    std::vector<std::string> stop_losses;  ///< warnings and errors since AppOptions::stop
    std::vector<std::string> validation_messages;
};

class RunReport {
public:
    /// Number of measured times kept of each kind: at least KEPT, at most twice as many.
    static constexpr size_t KEPT = 50'000;

    /// Restarts the measurement of first pictures, because another scan was opened.
    void opened(double time_s);
    /// Reports the press of a key or button, the effect of which the next frame will show.
    void asked(double time_s) { unanswered_s_.push_back(time_s); }
    bool has_unanswered() const { return !unanswered_s_.empty(); }

    /// A frame of the interface, when it has been submitted to the device.
    struct Frame {
        uint64_t number = 0;
        double begun_s = 0.0;
        double waited_s = 0.0;  ///< wait for running work
        bool moves = false;     ///< drawn because something moves
        bool shows_picture = false, shows_sharp_picture = false;
    };
    void presented(const Frame& frame);
    /// Reports that the device has finished all frames up to number `number`.
    void done(uint64_t number, double time_s);
    double last_begun_s() const { return last_begun_s_; }
    /// Returns the median duration of the last frames; 0 if there is none.
    double recent_frame_ms() const;

    /// Returns the report, without the members that only the application can fill.
    const AppReport& measured() const { return report_; }

private:
    struct Presented {
        Frame frame;
        std::vector<double> asked_s;
    };
    AppReport report_;
    std::vector<double> unanswered_s_;  ///< times of presses of keys and buttons whose effect no frame has shown yet
    std::vector<Presented> presented_;
    double opened_s_ = 0.0;
    double last_begun_s_ = 0.0;
    bool was_moving_ = false;
};

}  // namespace shvr::ui
