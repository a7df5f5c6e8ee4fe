#pragma once
// GPU time of each pass of a picture, over the last frames of the window and in a saved run. Pure, except for reading
// and writing; main thread only.

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
    bool is_of_profile = false;          ///< printed by `shvr profile`: each time is a median over frames
    const View::PassTime* find(const std::string& pass) const;
};
/// Reads a file from `save_pass_run` or the output of `shvr profile --json`. Errors name file, key and value.
PassRun read_pass_run(const std::filesystem::path& file);
void save_pass_run(const std::filesystem::path& file, const std::vector<View::PassTime>& passes);

/// Returns the difference between a pass and the run, "1.8 times", "0.4 ms more"...; empty if the run lacks the pass.
std::string change_in_words(const View::PassTime& pass, const PassRun& run);

/// Pass times of the present picture, recorded in each frame of the window. The totals grow until the picture changes;
/// the graph shows the difference between successive frames.
class PassLog {
public:
    static constexpr size_t MAX_FRAMES = 240;

    /// Records the passes of a frame at time `now_s`; does nothing while frozen.
    void note(double now_s, const std::vector<View::PassTime>& passes);
    void set_frozen(bool is_frozen) { is_frozen_ = is_frozen; }
    bool is_frozen() const { return is_frozen_; }
    /// Returns the times last recorded.
    const std::vector<View::PassTime>& passes() const { return passes_; }
    /// Returns the milliseconds of a pass in each recorded frame, oldest first; if the name is empty, the sum of all
    /// passes.
    std::vector<float> graph(const std::string& pass = {}) const;
    /// Returns the time from the oldest frame to the newest.
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
