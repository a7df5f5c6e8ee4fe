#pragma once
// What the bench found, and its forms: bench.json, bench.csv, tables of equal error and equal time, and what changed
// between two files. Plain data; any thread.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace shvr::bench {

/// Of a picture against the reference: in linear light, over red, green and blue of all pixels; PSNR, SSIM and FLIP in
/// 8 bits, as people see it (engine/base/image_metrics.h).
struct Error {
    double rmse = 0.0, max_abs = 0.0;
    std::optional<double> psnr_db;  ///< nothing where the 8-bit pictures are equal
    double ssim = 1.0, flip_mean = 0.0, flip_p99 = 0.0;
    double fraction_over_1 = 0.0, fraction_over_4 = 0.0;  ///< of the pixels, off by more levels of 255
};

/// Milliseconds from submission to completion.
struct Time {
    double min_ms = 0.0, median_ms = 0.0, p95_ms = 0.0;
    double low_ms = 0.0, high_ms = 0.0;  ///< where the median lies with 95 %, as drawing from the same times tells
};

struct Measured {
    std::string name, family;
    std::vector<std::string> settings;
    double scale = 1.0;
    Error error;
    Time time;
    double first_ms = 0.0;                               ///< of the first picture, which also prepares
    std::vector<std::pair<std::string, uint64_t>> work;  ///< exact counters
    uint64_t device_bytes = 0;
    int redraws = 0;  ///< timed pictures that were drawn again, since the first one made something that others use
    bool on_front = false;  ///< no other run of the scene is better in both error and median time
};

struct SceneResult {
    std::string name, what;
    std::string volume;              ///< "64 x 64 x 64 uint8"
    double reference_seconds = 0.0;  ///< 0: it was kept from before
    std::vector<Measured> runs;
    std::vector<std::string> notes = {};  ///< sentences: why another program is not among the runs
    /// Of fixed work of the processor (yardstick.h), in the same rounds; nothing where a GPU drew.
    std::optional<Time> yardstick = {};
};

struct Results {
    std::string device, driver, processor;
    std::string instructions;  ///< of the processor, those that change rounding
    std::string version;       ///< of SHVR
    std::string commit;        ///< of the tree that the program lies in; empty where it lies in none
    /// What drivers and SHVR look at: names that begin with LP_, GALLIVM_, MESA_, VK_, SHVR_ and their like.
    std::vector<std::pair<std::string, std::string>> environment = {};
    int cores = 0;
    double load = 0.0;  ///< of the machine when it began
    int rounds = 0;
    uint32_t width = 0, height = 0;
    std::vector<SceneResult> scenes;
    std::vector<std::string> left_out = {};  ///< sentences: scenes whose data is not there
};

/// A sentence where the machine was so busy that medians of few rounds are those of what else it did: its yardstick's
/// 95th percentile is over one and a half times its minimum.
std::optional<std::string> why_times_tell_little(const SceneResult& scene);

/// Sets `on_front`.
void find_front(std::vector<Measured>& runs);

nlohmann::ordered_json json_of(const Results& results);
/// Fails in a sentence where the file is not what json_of makes.
Results read_results(const std::filesystem::path& file);
/// One line a run.
std::string csv_of(const Results& results);
/// What is the same in every run of one machine: the error and the work of each run of SHVR's.
std::string front_csv(const Results& results);
/// The fastest run of each scene and family that has at most this RMSE.
std::string equal_error_csv(const Results& results);
/// The most exact run of each scene and family that takes no longer than each quality.
std::string equal_time_csv(const Results& results);

/// Another program's run, and what SHVR takes for an error that is no larger: its fastest run, and that of the same
/// step.
struct AtPeersError {
    std::string scene;
    const Measured* peer = nullptr;
    const Measured* fastest = nullptr;    ///< null: SHVR never comes as near
    const Measured* same_step = nullptr;  ///< whatever its error; null: none was measured
};
/// Pointers into `results`.
std::vector<AtPeersError> at_peers_errors(const Results& results);
/// Its rows, with SHVR's time over the other's.
std::string equal_peer_csv(const Results& results);

/// What is worse in `b` than in `a`: an error by more than 1 % (a picture's error is the same in every run of one
/// machine), a counter at all (where driver and instructions agree: elsewhere a ray may end a sample later), a median
/// by more than the noise of both (tools/report/noise.h), after both were measured by their yardsticks: a machine that
/// is busier is no slower program.
struct Change {
    std::string scene, run, what;  ///< "rmse", "samples", "median_ms"
    double a = 0.0, b = 0.0, noise = 0.0;
    bool is_regression = false;
    double machine = 1.0;  ///< of times: how much longer the yardstick took in `b`
};
struct Comparison {
    std::vector<Change> changes;      ///< all that differ; regressions first
    std::vector<std::string> beside;  ///< sentences: runs that only one of them has, times that tell nothing
};
/// Fails where the two have no run in common. `with_times`: times, too.
Comparison compare(const Results& a, const Results& b, bool with_times);

}  // namespace shvr::bench
