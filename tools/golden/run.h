#pragma once
// Draws goldens, compares them with the blessed pictures, and writes the files for judging differences: pictures,
// results.json, junit.xml and report.html. Does not retry: a picture that differs only sometimes is a defect.

#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "tools/golden/blessing.h"

namespace shvr::golden {

enum class Status {
    passed,
    failed,      ///< the picture or the work counters differ
    missing,     ///< not blessed yet, or picture and side-car do not match
    broken,      ///< could not be drawn
    informative  ///< the picture differs, but the device is not lavapipe and may round differently
};
inline constexpr Spelling<Status> STATUSES[] = {{Status::passed, "passed"},
                                                {Status::failed, "failed"},
                                                {Status::missing, "missing"},
                                                {Status::broken, "broken"},
                                                {Status::informative, "informative"}};
constexpr std::span<const Spelling<Status>> spellings_of(Status)
{
    return STATUSES;
}
constexpr bool is_failure(Status status)
{
    return status != Status::passed && status != Status::informative;
}

/// Returns whether `shvr golden bless` may help: false if drawing failed, or on a device that may not bless.
constexpr bool can_be_blessed(Status status)
{
    return status == Status::failed || status == Status::missing;
}

/// The result of one golden. Pictures that do not exist are null.
struct Result {
    Golden golden;
    Status status = Status::broken;
    std::string reason;  ///< why the golden did not pass, as a sentence
    double seconds = 0.0;
    std::optional<Image8> expected, actual;
    std::optional<ImageF> light;  ///< the actual picture; null for a run read from disk
    std::optional<ImageDifference> difference;
    std::optional<Maker> maker;
    std::string side_car;  ///< its JSON
};

/// Draws a golden and judges it. Defects of the golden are part of the result, not exceptions.
Result run(const Golden& golden, const StudioOptions& options);

/// Runs all goldens and creates `output`. While the run lasts, the report states that the run has not ended, so that a
/// crash is visible. `tell` is called before each golden. `keeps_light`: also writes NAME.actual.pfm, the picture in
/// 32-bit floats.
struct Outcome {
    std::vector<Result> results;
    std::vector<std::string> failed;
    std::filesystem::path report;
};
Outcome run_all(const std::vector<Golden>& goldens, const std::filesystem::path& output, const StudioOptions& options,
                const std::function<void(const Golden&, double)>& tell = {}, bool keeps_light = false);

/// One of several processes that share `output`: draws these goldens and writes their pictures, and `results`, a file
/// like results.json.
void run_part(const std::vector<Golden>& goldens, const std::filesystem::path& output,
              const std::filesystem::path& results, const StudioOptions& options,
              const std::function<void(const Golden&, double)>& tell = {}, bool keeps_light = false);
/// Reads the results of all of these processes, and writes the files that one process writes for `goldens`. Fails if a
/// golden has no result.
Outcome join_parts(const std::vector<Golden>& goldens, const std::filesystem::path& output,
                   const std::vector<std::filesystem::path>& results);

/// Reads the results.json and pictures of an earlier run from `output`, so that its reports can be written again.
Outcome read_run(const std::filesystem::path& output, const std::string& pattern);
void write_reports(const Outcome& outcome, const std::filesystem::path& output);

nlohmann::ordered_json json_of(const Result& result);
/// Returns a self-contained page, failures first. Shows the expected and actual pictures, their difference times 16,
/// and FLIP; offers a slider, blinking (key b), both colours under the pointer, metrics, and the command that blesses.
std::string page_of(const std::vector<Result>& results);
std::string junit_of(const std::vector<Result>& results);

}  // namespace shvr::golden
