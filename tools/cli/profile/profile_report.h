#pragma once
// The measurements of `shvr profile` and their output formats: a summary, a trace for Perfetto, a table, a graph.

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/cli.h"

namespace shvr::cli {

struct ProfiledFrame {
    double begin_ms = 0.0, end_ms = 0.0;  ///< begin and end of the render call, host's clock; 0: first frame
    double wall_ms = 0.0;                 ///< from submission to completion
    uint64_t device_bytes = 0;
    std::vector<gpu::PassReport> passes;
};

struct Profile {
    std::string input, device, driver;
    glm::uvec2 size{0};
    int warmup = 0;
    bool serialize = false;
    std::chrono::steady_clock::time_point measured_from{};  ///< start of the frames' clock
    std::vector<gpu::PassReport> first_frame;               ///< passes of the first frame: with uploads, leap grid
    std::vector<ProfiledFrame> frames;                      ///< after the warm-up
    std::vector<gpu::PassReport> counted;                   ///< one more frame, with work counters
    Json bytes;
    uint64_t device_budget = 0, host_budget = 0;  ///< bytes
    FrameGraph graph;                             ///< the last frame's
    bool complete = true;                         ///< the pictures lack nothing
    int64_t voxels_not_read = 0;                  ///< number of unreadable voxels, for which the lowest value of the
                                                  ///< volume's type is drawn
    std::vector<std::string> warnings;
};

/// Statistics of repeated measurements of the same work. p95: at least 95 % of the values are at or below this value.
struct Spread {
    double minimum = 0.0, median = 0.0, p95 = 0.0, maximum = 0.0;
};
/// Null if there are no values.
std::optional<Spread> spread_of(std::vector<double> values);

/// Returns the resources of a frame with their lifetimes, and the memory that its transient resources would need if
/// they shared memory. README.md lists the keys.
Json frame_memory_of(const FrameGraph& graph);

/// README.md lists the keys.
Json summary_of(const Profile& profile);
std::string text_of(const Json& summary);

/// Returns Chrome trace events, a format that Perfetto reads. Times are microseconds since the first frame.
std::string trace_of(const Profile& profile);
/// One row per frame and pass.
std::string csv_of(const Profile& profile);

/// Returns a self-contained page: frames and passes over time, memory over time, passes, work, resources.
std::string page_of(const Profile& profile);

/// Writes .dot, .svg (by running the program `dot`) or .json, depending on the extension of `path`.
void write_graph(const std::filesystem::path& path, const FrameGraph& graph);

void write_text(const std::filesystem::path& path, const std::string& text);

/// A timed pass and its position in a drawing of the passes. The clocks of host and device are independent, so the
/// passes are placed such that the last one ends with its frame. Overlapping passes get separate lanes.
struct PlacedPass {
    size_t frame = 0, pass = 0;  ///< indices
    double begin_ms = 0.0;       ///< on the frames' clock
    size_t lane = 0;
    bool is_first = false;  ///< the frame's first pass
};
/// In order of execution.
std::vector<PlacedPass> placed_passes(const Profile& profile);

/// Returns when the host recorded each pass of a frame, and for how long, in milliseconds on the frames' clock. Passes
/// are recorded one after the other, within the frame.
std::vector<std::pair<double, double>> recorded_in(const Profile& profile, const ProfiledFrame& frame);

/// Compares two summaries, of frames or of sessions: README.md lists the keys. `a_name`, `b_name`: names of the files.
Json difference_of(const Json& a, const std::string& a_name, const Json& b, const std::string& b_name);
std::string difference_text(const Json& difference);

/// Returns lines with aligned columns: the first column is left-aligned, the others are right-aligned.
std::string table_text(const std::vector<std::vector<std::string>>& rows);
/// Three decimals, or "-" for null.
std::string number_text(const Json& value);

}  // namespace shvr::cli
