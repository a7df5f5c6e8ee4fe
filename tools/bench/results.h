#pragma once
// The bench's results and their output formats: bench.json, bench.csv, tables of equal error and equal time, and the
// changes between two files. Plain data; any thread.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace shvr::bench {

/// Error of a picture relative to the reference. RMSE and maximum: in linear light, over red, green and blue of all
/// pixels. PSNR, SSIM and FLIP: of 8-bit colours, as displayed (engine/base/image_metrics.h).
struct Error {
    double rmse = 0.0, max_abs = 0.0;
    double alpha_rmse = 0.0, alpha_max_abs = 0.0;  ///< the same errors for alpha; NaN if not measured
    std::optional<double> psnr_db;                 ///< null if the 8-bit colours are equal
    double ssim = 1.0, flip_mean = 0.0, flip_p99 = 0.0;
    double fraction_over_1 = 0.0, fraction_over_4 = 0.0;  ///< fraction of pixels off by more than 1, or 4, of 255
};

/// Milliseconds from submission to completion.
struct Time {
    double min_ms = 0.0, median_ms = 0.0, p95_ms = 0.0;
    double low_ms = 0.0, high_ms = 0.0;  ///< 95 % confidence interval of the median, by bootstrap
};

struct Measured {
    std::string name, family;
    std::vector<std::string> settings;
    double scale = 1.0;
    Error error;
    Time time;
    double first_ms = 0.0;                               ///< time of the first picture, which includes its preparation
    std::vector<std::pair<std::string, uint64_t>> work;  ///< exact counters
    uint64_t device_bytes = 0;
    int redraws = 0;        ///< number of timed pictures drawn again, because the first drawing created shared data
    bool on_front = false;  ///< on the Pareto front: no other run of the scene is better in both error and median time
};

struct SceneResult {
    std::string name, what;
    std::string volume;              ///< "64 x 64 x 64 uint8"
    double reference_seconds = 0.0;  ///< time of drawing the reference; 0: it was stored
    std::vector<Measured> runs;
    std::vector<std::string> notes = {};  ///< sentences that state why the comparison program has no run here
    /// Time of a fixed amount of processor work (yardstick.h), in the same rounds; null if the device is a GPU.
    std::optional<Time> yardstick = {};
};

struct Results {
    std::string device, driver, processor;
    std::string instructions;  ///< instruction sets of the processor, on which rounding depends
    std::string version;       ///< version of SHVR
    std::string commit;        ///< commit of the source tree that the program was built in; empty if unknown
    /// Environment variables that affect drivers and SHVR: names that begin with LP_, GALLIVM_, MESA_, VK_, SHVR_ and
    /// the like.
    std::vector<std::pair<std::string, std::string>> environment = {};
    int cores = 0;
    double load = 0.0;  ///< system load of the machine at the start
    int rounds = 0;
    uint32_t width = 0, height = 0;
    std::vector<SceneResult> scenes;
    std::vector<std::string> left_out = {};  ///< sentences: scenes whose data is missing
};

/// Returns a warning if the machine was so busy that medians of few rounds reflect its other load: if the yardstick's
/// 95th percentile is more than one and a half times its minimum.
std::optional<std::string> why_times_tell_little(const SceneResult& scene);

/// Sets `on_front` of each run.
void find_front(std::vector<Measured>& runs);

nlohmann::ordered_json json_of(const Results& results);
/// Fails with a sentence if the file is not in the format of json_of.
Results read_results(const std::filesystem::path& file);
/// The same for JSON that is part of the file `name`.
Results results_of(const nlohmann::ordered_json& json, const std::string& name);
/// One line per run.
std::string csv_of(const Results& results);
/// Lists the values that repeat exactly on the same machine: the error and the work of each of SHVR's runs.
std::string front_csv(const Results& results);
/// Lists, for each scene, family and limit of the RMSE, the fastest run whose RMSE is at most that limit.
std::string equal_error_csv(const Results& results);
/// Lists, for each scene, family and quality preset, the run with the smallest error that is no slower than the preset.
std::string equal_time_csv(const Results& results);

/// A run of the comparison program, and two runs of SHVR: the fastest run whose error is no larger, and the run with
/// the same step.
struct AtPeersError {
    std::string scene;
    const Measured* peer = nullptr;
    const Measured* fastest = nullptr;    ///< null if every run of SHVR has a larger error
    const Measured* same_step = nullptr;  ///< SHVR's run with the same step, whatever its error; null: not measured
};
/// The results point into `results`.
std::vector<AtPeersError> at_peers_errors(const Results& results);
/// Returns at_peers_errors as a table, with SHVR's time relative to the comparison program's time.
std::string equal_peer_csv(const Results& results);

/// A difference between `a` and `b`. Errors are listed if they differ by more than 1 % (a picture's error is the same
/// in every run on one machine). Counters are listed if they differ at all, provided that driver and instructions agree
/// (otherwise a ray may end a sample later). Medians are listed if they differ by more than the noise of both
/// (tools/report/noise.h), after scaling by the yardsticks: a busier machine does not mean a slower program.
struct Change {
    std::string scene, run, what;  ///< "rmse", "samples", "median_ms"
    double a = 0.0, b = 0.0, noise = 0.0;
    bool is_regression = false;
    double machine = 1.0;  ///< for times only: the yardstick's time in `b` divided by that in `a`
};
struct Comparison {
    std::vector<Change> changes;      ///< all differences; regressions first
    std::vector<std::string> beside;  ///< sentences about runs that only one file has, and times not comparable
};
/// Fails if the two results have no run in common. `with_times`: compares times, too.
Comparison compare(const Results& a, const Results& b, bool with_times);

}  // namespace shvr::bench
