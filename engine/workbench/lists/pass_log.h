#pragma once
// What the device spends on each pass of pictures: over the last frames of the window, and in a run that was saved.
// Pure, but for reading and writing; the main thread.

#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/live/view.h"

namespace shvr::ui {

/// What the passes of one picture took.
struct PassRun {
    std::string name;                    ///< of the file
    std::vector<View::PassTime> passes;  ///< in the order of the file
    bool is_of_profile = false;          ///< printed by shvr profile: each is the median of a frame
    const View::PassTime* find(const std::string& pass) const;
};
/// Reads what `save_passes` wrote, or what `shvr profile --json` prints. Fails naming file, key and value.
PassRun read_pass_run(const std::filesystem::path& file);
void save_pass_run(const std::filesystem::path& file, const std::vector<View::PassTime>& passes);

/// "1.8 times", "0.4 ms more"...: how much longer a pass took than in the run; empty where the run has no such pass.
std::string change_in_words(const View::PassTime& pass, const PassRun& run);

/// The times of the present picture, frame by frame of the window. Their totals grow until the picture changes; what
/// was added since the frame before is what the graph shows.
class PassLog {
public:
    static constexpr size_t MAX_FRAMES = 240;

    /// Of a frame at that time; does nothing while frozen.
    void note(double now_s, const std::vector<View::PassTime>& passes);
    void set_frozen(bool is_frozen) { is_frozen_ = is_frozen; }
    bool is_frozen() const { return is_frozen_; }
    /// As last noted.
    const std::vector<View::PassTime>& passes() const { return passes_; }
    /// Milliseconds that passes took between one noted frame and the next, oldest first: of one, or of all where the
    /// name is empty.
    std::vector<float> graph(const std::string& pass = {}) const;
    /// From the oldest frame to the newest.
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
