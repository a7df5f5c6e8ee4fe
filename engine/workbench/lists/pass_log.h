#pragma once
// GPU time of each pass of pictures: over the last frames of the window, and in a saved run.
// Pure, except for reading and writing; the main thread.

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
    bool is_of_profile = false;          ///< printed by shvr profile: each time is the median of a frame
    const View::PassTime* find(const std::string& pass) const;
};
/// Reads a file that `save_passes` wrote, or the output of `shvr profile --json`. Fails naming file, key and value.
PassRun read_pass_run(const std::filesystem::path& file);
void save_pass_run(const std::filesystem::path& file, const std::vector<View::PassTime>& passes);

/// Returns "1.8 times", "0.4 ms more"...: the difference of a pass from the run; empty if the run has no such pass.
std::string change_in_words(const View::PassTime& pass, const PassRun& run);

/// Pass times of the present picture, frame by frame of the window. Their totals grow until the picture changes; the
/// graph shows the difference from one frame to the next.
class PassLog {
public:
    static constexpr size_t MAX_FRAMES = 240;

    /// Records a frame at that time; does nothing while frozen.
    void note(double now_s, const std::vector<View::PassTime>& passes);
    void set_frozen(bool is_frozen) { is_frozen_ = is_frozen; }
    bool is_frozen() const { return is_frozen_; }
    /// Returns the times last recorded.
    const std::vector<View::PassTime>& passes() const { return passes_; }
    /// Returns the milliseconds of a pass in each recorded frame, oldest first; the sum of all passes if the name is
    /// empty.
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
