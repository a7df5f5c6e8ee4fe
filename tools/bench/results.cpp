#include "tools/bench/results.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "tools/bench/peer.h"
#include "tools/report/noise.h"

namespace shvr::bench {

namespace {

using Json = nlohmann::ordered_json;
constexpr int64_t MAX_BENCH_BYTES = int64_t{64} << 20;
constexpr int SCHEMA = 1;
constexpr double ERROR_MARGIN = 1.01;
constexpr double MIN_ERROR = 1e-7;  // of a float
/// Stands for the error of alpha, which files of older versions lack: comparisons with NaN find no difference.
constexpr double NOT_MEASURED = std::numeric_limits<double>::quiet_NaN();

Json json_of(const Measured& run)
{
    Json work = Json::object();
    for (const auto& [name, value] : run.work) work[name] = value;
    const Error& error = run.error;
    return {{"name", run.name},
            {"family", run.family},
            {"settings", run.settings},
            {"scale", run.scale},
            {"error",
             {{"rmse", error.rmse},
              {"max_abs", error.max_abs},
              {"alpha_rmse", error.alpha_rmse},
              {"alpha_max_abs", error.alpha_max_abs},
              {"psnr_db", error.psnr_db ? Json(*error.psnr_db) : Json(nullptr)},
              {"ssim", error.ssim},
              {"flip_mean", error.flip_mean},
              {"flip_p99", error.flip_p99},
              {"fraction_over_1", error.fraction_over_1},
              {"fraction_over_4", error.fraction_over_4}}},
            {"min_ms", run.time.min_ms},
            {"median_ms", run.time.median_ms},
            {"median_low_ms", run.time.low_ms},
            {"median_high_ms", run.time.high_ms},
            {"p95_ms", run.time.p95_ms},
            {"first_ms", run.first_ms},
            {"work", work},
            {"device_bytes", run.device_bytes},
            {"redraws", run.redraws},
            {"on_front", run.on_front}};
}

Measured measured_of(const Json& json)
{
    Measured run{.name = json.at("name"), .family = json.at("family")};
    run.settings = json.at("settings").get<std::vector<std::string>>();
    run.scale = json.at("scale");
    const Json& error = json.at("error");
    run.error = {.rmse = error.at("rmse"),
                 .max_abs = error.at("max_abs"),
                 .alpha_rmse = error.value("alpha_rmse", NOT_MEASURED),
                 .alpha_max_abs = error.value("alpha_max_abs", NOT_MEASURED),
                 .psnr_db = {},
                 .ssim = error.at("ssim"),
                 .flip_mean = error.at("flip_mean"),
                 .flip_p99 = error.at("flip_p99"),
                 .fraction_over_1 = error.value("fraction_over_1", 0.0),
                 .fraction_over_4 = error.value("fraction_over_4", 0.0)};
    if (!error.at("psnr_db").is_null()) run.error.psnr_db = error.at("psnr_db").get<double>();
    run.time = {json.at("min_ms"), json.at("median_ms"), json.at("p95_ms")};
    run.time.low_ms = json.value("median_low_ms", run.time.min_ms);
    run.time.high_ms = json.value("median_high_ms", run.time.p95_ms);
    run.first_ms = json.at("first_ms");
    for (const auto& [name, value] : json.at("work").items()) run.work.emplace_back(name, value.get<uint64_t>());
    run.device_bytes = json.at("device_bytes");
    run.redraws = json.value("redraws", 0);
    run.on_front = json.at("on_front");
    return run;
}

/// The parts of two files that are compared with each other.
struct Looked {
    size_t a_rounds = 0, b_rounds = 0;
    bool at_work = false, at_times = false;
};

/// Noise of the median in milliseconds; null if there were too few rounds to estimate it.
std::optional<double> noise_of(const Time& time, size_t rounds)
{
    return report::noise_of(time.min_ms, time.p95_ms, rounds);
}

/// Divides `time` by `machine`, the ratio of both yardstick times, to make it comparable with the other machine's.
Time scaled(const Time& time, double machine)
{
    return {time.min_ms / machine, time.median_ms / machine, time.p95_ms / machine, time.low_ms / machine,
            time.high_ms / machine};
}

void compare_times(const SceneResult& of_a, const Measured& a, const SceneResult& of_b, const Measured& b,
                   const Looked& looked, std::vector<Change>& changes)
{
    double machine = 1.0, of_yardsticks = 0.0;
    if (of_a.yardstick && of_b.yardstick && of_a.yardstick->median_ms > 0.0 && of_b.yardstick->median_ms > 0.0) {
        machine = of_b.yardstick->median_ms / of_a.yardstick->median_ms;
        const auto relative = [](const Time& time, size_t rounds) {
            return noise_of(time, rounds).value_or(0.0) / time.median_ms;
        };
        of_yardsticks =
            std::hypot(relative(*of_a.yardstick, looked.a_rounds), relative(*of_b.yardstick, looked.b_rounds));
    }
    const Time as_in_a = scaled(b.time, machine);
    const std::optional<double> noise =
        report::noise_of_both(noise_of(a.time, looked.a_rounds), noise_of(as_in_a, looked.b_rounds));
    if (!noise) return;
    const double all = std::hypot(*noise, of_yardsticks * a.time.median_ms);
    if (std::abs(as_in_a.median_ms - a.time.median_ms) <= all) return;
    changes.push_back({of_a.name, a.name, "median_ms", a.time.median_ms, b.time.median_ms, all,
                       as_in_a.median_ms > a.time.median_ms, machine});
}

void compare_runs(const SceneResult& of_a, const Measured& a, const SceneResult& of_b, const Measured& b,
                  const Looked& looked, std::vector<Change>& changes)
{
    const auto add = [&](const std::string& what, double from, double to, bool is_worse) {
        if (from != to) changes.push_back({of_a.name, a.name, what, from, to, 0.0, is_worse});
    };
    const auto error = [&](const char* what, double from, double to) {
        if (to > from * ERROR_MARGIN + MIN_ERROR || from > to * ERROR_MARGIN + MIN_ERROR)
            add(what, from, to, to > from);
    };
    error("rmse", a.error.rmse, b.error.rmse);
    error("max_abs", a.error.max_abs, b.error.max_abs);
    error("alpha_rmse", a.error.alpha_rmse, b.error.alpha_rmse);
    error("alpha_max_abs", a.error.alpha_max_abs, b.error.alpha_max_abs);
    for (const auto& [name, value] : b.work) {
        const auto before = std::ranges::find(a.work, name, &std::pair<std::string, uint64_t>::first);
        if (before == a.work.end() || !looked.at_work) continue;
        // Skipped bricks, leaps and rays that end early save work, so a larger count is an improvement.
        const bool saves = name == "bricks_skipped" || name == "rays_terminated_early" || name == "leaps";
        add(name, double(before->second), double(value), !saves && value > before->second);
    }
    if (looked.at_times) compare_times(of_a, a, of_b, b, looked, changes);
}

/// Returns the run of `scene` that was drawn with the settings of `run`; null if there is none.
const Measured* same_run(const SceneResult& scene, const Measured& run)
{
    const auto found = std::ranges::find(scene.runs, run.name, &Measured::name);
    return found != scene.runs.end() && found->settings == run.settings ? &*found : nullptr;
}

/// Describes the content that only `a` has: "only A has tubes; tissue: step 4". Null if there is none.
std::optional<std::string> only_in(const Results& a, const Results& b, const char* name)
{
    std::string found;
    for (const SceneResult& scene : a.scenes) {
        const auto other = std::ranges::find(b.scenes, scene.name, &SceneResult::name);
        std::string runs;
        if (other != b.scenes.end())
            for (const Measured& run : scene.runs)
                if (!same_run(*other, run)) runs += (runs.empty() ? "" : ", ") + run.name;
        if (other != b.scenes.end() && runs.empty()) continue;
        found += (found.empty() ? "" : "; ") + scene.name + (runs.empty() ? "" : ": " + runs);
    }
    if (found.empty()) return std::nullopt;
    return sentence("only ", name, " has ", found);
}

}  // namespace

std::optional<std::string> why_times_tell_little(const SceneResult& scene)
{
    constexpr double BUSY = 1.5;
    if (!scene.yardstick || scene.yardstick->p95_ms <= BUSY * scene.yardstick->min_ms) return std::nullopt;
    return sentence("The machine was busy: the same work of the processor took ", std::setprecision(2),
                    scene.yardstick->min_ms, " to ", scene.yardstick->p95_ms,
                    " ms. Times of this scene, and what is on its front, tell little; errors and work are exact.");
}

void find_front(std::vector<Measured>& runs)
{
    for (Measured& run : runs) {
        const auto is_better = [&](const Measured& other) {
            const bool no_worse = other.error.rmse <= run.error.rmse && other.time.median_ms <= run.time.median_ms;
            return no_worse && (other.error.rmse < run.error.rmse || other.time.median_ms < run.time.median_ms);
        };
        run.on_front = std::ranges::none_of(runs, is_better);
    }
}

Json json_of(const Results& results)
{
    Json scenes = Json::array();
    for (const SceneResult& scene : results.scenes) {
        Json runs = Json::array();
        for (const Measured& run : scene.runs) runs.push_back(json_of(run));
        Json yardstick;
        if (const auto& time = scene.yardstick)
            yardstick = {{"min_ms", time->min_ms}, {"median_ms", time->median_ms}, {"p95_ms", time->p95_ms}};
        scenes.push_back({{"name", scene.name},
                          {"what", scene.what},
                          {"volume", scene.volume},
                          {"reference_seconds", scene.reference_seconds},
                          {"notes", scene.notes},
                          {"yardstick", yardstick},
                          {"runs", runs}});
    }
    Json environment = Json::object();
    for (const auto& [name, value] : results.environment) environment[name] = value;
    return {{"shvr_bench", SCHEMA},
            {"version", results.version},
            {"commit", results.commit.empty() ? Json(nullptr) : Json(results.commit)},
            {"environment", environment},
            {"device", results.device},
            {"driver", results.driver},
            {"processor", results.processor},
            {"instructions", results.instructions},
            {"cores", results.cores},
            {"load", results.load},
            {"rounds", results.rounds},
            {"size", {results.width, results.height}},
            {"left_out", results.left_out},
            {"scenes", scenes}};
}

Results read_results(const std::filesystem::path& file)
{
    return results_of(Json::parse(read_text(file, MAX_BENCH_BYTES), nullptr, false), file.string());
}

Results results_of(const Json& json, const std::string& name)
{
    if (!json.is_object() || json.value("shvr_bench", 0) != SCHEMA)
        fail(name, ": is no bench.json of version ", SCHEMA, "; expected what shvr bench writes");
    try {
        Results results{.device = json.at("device"), .driver = json.at("driver"), .processor = json.at("processor")};
        results.instructions = json.at("instructions");
        results.version = json.value("version", "");
        if (const auto commit = json.find("commit"); commit != json.end() && commit->is_string())
            results.commit = commit->get<std::string>();
        const Json environment = json.value("environment", Json::object());
        for (const auto& [variable, value] : environment.items())
            results.environment.emplace_back(variable, value.get<std::string>());
        results.cores = json.at("cores");
        results.load = json.at("load");
        results.rounds = json.at("rounds");
        results.width = json.at("size").at(0);
        results.height = json.at("size").at(1);
        for (const Json& scene : json.at("scenes")) {
            results.scenes.push_back(
                {scene.at("name"), scene.at("what"), scene.at("volume"), scene.at("reference_seconds"), {}});
            results.scenes.back().notes = scene.value("notes", std::vector<std::string>());
            if (const auto yardstick = scene.find("yardstick"); yardstick != scene.end() && yardstick->is_object())
                results.scenes.back().yardstick =
                    Time{yardstick->at("min_ms"), yardstick->at("median_ms"), yardstick->at("p95_ms")};
            for (const Json& run : scene.at("runs")) results.scenes.back().runs.push_back(measured_of(run));
        }
        results.left_out = json.value("left_out", std::vector<std::string>());
        return results;
    } catch (const Json::exception& error) {
        fail(name, ": is not what shvr bench writes: ", error.what());
    }
}

Comparison compare(const Results& a, const Results& b, bool with_times)
{
    Comparison found;
    size_t common = 0;
    Looked looked{.a_rounds = size_t(std::max(a.rounds, 0)),
                  .b_rounds = size_t(std::max(b.rounds, 0)),
                  .at_work = a.driver == b.driver && a.instructions == b.instructions,
                  .at_times = with_times};
    if (with_times && std::min(looked.a_rounds, looked.b_rounds) < report::MIN_TIMES) {
        looked.at_times = false;
        found.beside.push_back(
            sentence("times are not compared: fewer than ", report::MIN_TIMES, " rounds tell no noise (--rounds)"));
    }
    for (const SceneResult& scene : a.scenes) {
        const auto other = std::ranges::find(b.scenes, scene.name, &SceneResult::name);
        if (other == b.scenes.end()) continue;
        for (const Measured& run : scene.runs) {
            const Measured* const same = same_run(*other, run);
            if (!same) continue;
            ++common;
            compare_runs(scene, run, *other, *same, looked, found.changes);
        }
    }
    if (common == 0) fail("the two files have no run of a scene in common; expected results of the same scenes");
    for (const auto& alone : {only_in(a, b, "A"), only_in(b, a, "B")})
        if (alone) found.beside.push_back(*alone);
    std::ranges::stable_sort(found.changes, std::greater<>(), &Change::is_regression);
    return found;
}

}  // namespace shvr::bench
