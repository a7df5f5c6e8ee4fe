#pragma once
// GPU time of each pass: in the window's last frames, and in a run saved to a file. Pure, except for reading and
// writing files; main thread only.

#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/live/view.h"

namespace shvr::ui {

/// Pass times of one picture.
struct PassRun {
    std::string name;                    ///< the file's name
    std::vector<View::PassTime> passes;  ///< in the file's order
    bool is_of_profile = false;          ///< printed by `shvr profile`, where each time is a median over frames
    const View::PassTime* find(const std::string& pass) const;
};
/// Reads a file from `save_pass_run` or the output of `shvr profile --json`. Errors name file, key and value.
PassRun read_pass_run(const std::filesystem::path& file);
void save_pass_run(const std::filesystem::path& file, const std::vector<View::PassTime>& passes);

/// Returns the time of a pass relative to its time in the run, such as "x 1.80"; empty if the run lacks the pass.
std::string change_in_words(const View::PassTime& pass, const PassRun& run);

/// GPU times of the passes of the present picture. Totals grow while the picture is refined, and start again with the
/// next picture; the graph shows how much each frame added.
class PassLog {
public:
    static constexpr size_t MAX_FRAMES = 240;

    /// Records the totals of passes at time `now_s`, once a frame; does nothing while frozen.
    void note(double now_s, const std::vector<View::PassTime>& passes);
    void set_frozen(bool is_frozen) { is_frozen_ = is_frozen; }
    bool is_frozen() const { return is_frozen_; }
    /// Returns the times last recorded.
    const std::vector<View::PassTime>& passes() const { return passes_; }
    /// Returns the milliseconds that each recorded frame spent in a pass, oldest first. If the name is empty, adds up
    /// all passes.
    std::vector<float> graph(const std::string& pass = {}) const;
    /// Returns the seconds between the oldest and the newest recorded frame.
    double seconds() const;

private:
    struct Frame {
        double at_s = 0.0;
        std::map<std::string, double> added_ms;
    };
    std::vector<View::PassTime> passes_;
    std::deque<Frame> frames_;
    bool is_frozen_ = false;
};

}  // namespace shvr::ui
