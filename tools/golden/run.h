#pragma once
// Draws goldens, compares them with the blessed ones, and writes the files needed to judge them: pictures,
// results.json, junit.xml and report.html. No retries: a picture that differs only sometimes is a defect.

#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "tools/golden/blessing.h"

namespace shvr::golden {

enum class Status {
    passed,
    failed,      ///< the picture or the work counters differ
    missing,     ///< never blessed, or picture and side-car do not match
    broken,      ///< could not be drawn
    informative  ///< the picture differs, but the device is not lavapipe: its rounding may differ
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

/// Returns whether `shvr golden bless` helps: not if nothing was drawn, nor on a device that may not bless.
constexpr bool can_be_blessed(Status status)
{
    return status == Status::failed || status == Status::missing;
}

/// The result of one golden. Pictures are null if there are none.
struct Result {
    Golden golden;
    Status status = Status::broken;
    std::string reason;  ///< why it did not pass, in a sentence
    double seconds = 0.0;
    std::optional<Image8> expected, actual;
    std::optional<ImageF> light;  ///< the actual picture; null for a run read from disk
    std::optional<ImageDifference> difference;
    std::optional<Maker> maker;
    std::string side_car;  ///< its JSON
};

/// Draws a golden and judges it; never throws for defects of the golden.
Result run(const Golden& golden, const StudioOptions& options);

/// Runs all goldens. Until the run ends, the report states that it did not end, so that a crash is visible. `output` is
/// created. `tell` is called before each golden. `keeps_light`: also writes NAME.actual.pfm, the picture in 32-bit
/// floats.
struct Outcome {
    std::vector<Result> results;
    std::vector<std::string> failed;
    std::filesystem::path report;
};
Outcome run_all(const std::vector<Golden>& goldens, const std::filesystem::path& output, const StudioOptions& options,
                const std::function<void(const Golden&, double)>& tell = {}, bool keeps_light = false);

/// Reads a run whose results.json and pictures are in `output`, to write its reports again.
Outcome read_run(const std::filesystem::path& output, const std::string& pattern);
void write_reports(const Outcome& outcome, const std::filesystem::path& output);

nlohmann::ordered_json json_of(const Result& result);
/// Returns a self-contained page with the failures first. Shows expected and actual pictures, their difference times
/// 16, and FLIP; has a slider, blinking (key b), both colours under the pointer, metrics, and the command that blesses.
std::string page_of(const std::vector<Result>& results);
std::string junit_of(const std::vector<Result>& results);

}  // namespace shvr::golden
