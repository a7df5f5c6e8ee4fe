#include "tools/golden/run.h"

#include <algorithm>
#include <chrono>

#include <nlohmann/json.hpp>

#include "engine/base/file.h"
#include "engine/base/image_file.h"
#include "engine/base/text.h"
#include "engine/pages/html.h"

namespace shvr::golden {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;
constexpr int64_t MAX_RESULTS_BYTES = int64_t{64} << 20;

/// Everything except the duration.
void judge(Result& result, const StudioOptions& options)
{
    const Golden& golden = result.golden;
    if (fs::exists(golden.picture())) result.expected = read_png(golden.picture());
    if (fs::exists(golden.side_car())) result.side_car = trimmed(read_text(golden.side_car(), MAX_RESULTS_BYTES));
    Studio studio(golden, options);
    Drawn drawn = drawn_by(studio);
    result.actual = drawn.image;
    result.light = drawn.light;
    result.maker = drawn.maker;
    if (const std::vector<std::string> messages = studio.take_validation_messages(); !messages.empty())
        fail(golden.file().string(), ": ", messages.size(), " validation messages, the first: ", messages.front());
    if (const std::optional<std::string> why = why_not_blessed(golden)) {
        result.status = Status::missing;
        result.reason = *why;
        return;
    }
    const bool same_size = result.expected->width == drawn.image.width && result.expected->height == drawn.image.height;
    if (same_size) result.difference = compare(drawn.image, *result.expected);
    std::optional<std::string> why = why_different(drawn.image, *result.expected, golden.strictness);
    if (!why) why = why_other_work(golden, drawn);
    result.reason = why.value_or("");
    result.status = !why ? Status::passed : studio.is_lavapipe() ? Status::failed : Status::informative;
}

void write_pictures(const Result& result, const fs::path& output)
{
    const std::string start = (output / result.golden.name).string();
    if (result.actual) write_png(start + ".actual.png", *result.actual);
    if (result.expected) write_png(start + ".expected.png", *result.expected);
    if (result.difference) write_png(start + ".difference.png", difference_picture(*result.actual, *result.expected));
}

std::optional<Image8> picture_at(const std::string& path)
{
    return is_file(path) ? std::optional(read_png(path)) : std::nullopt;
}

Status status_named(const std::string& name)
{
    for (const Spelling<Status>& each : STATUSES)
        if (each.name == name) return each.value;
    fail("status ", in_quotes(name), " is unknown; expected what shvr golden run writes");
}

Result result_of(const Json& json, const fs::path& output)
{
    Result result;
    result.golden = {.name = json.at("name"), .folder = json.at("folder").get<std::string>(), .why = json.at("why")};
    result.golden.loosened = json.at("loosened");
    for (const Spelling<Strictness>& each : STRICTNESSES)
        if (json.at("class") == each.name) result.golden.strictness = each.value;
    result.status = status_named(json.at("status"));
    result.reason = json.at("reason");
    result.seconds = json.at("seconds");
    const std::string start = (output / result.golden.name).string();
    result.actual = picture_at(start + ".actual.png");
    result.expected = picture_at(start + ".expected.png");
    if (!json.at("metrics").is_null() && result.actual && result.expected)
        result.difference = compare(*result.actual, *result.expected);
    if (!json.at("drawn_by").is_null())
        result.maker = Maker{json["drawn_by"].at("device"), json["drawn_by"].at("driver"),
                             json["drawn_by"].at("processor"), json["drawn_by"].at("instructions")};
    result.side_car = json.at("blessed").is_null() ? "" : json["blessed"].dump(2);
    return result;
}

std::vector<std::string> failures_of(const std::vector<Result>& results)
{
    std::vector<std::string> failed;
    for (const Result& result : results)
        if (is_failure(result.status)) failed.push_back(result.golden.name);
    return failed;
}

std::vector<Result> run_some(const std::vector<Golden>& goldens, const fs::path& output, const StudioOptions& options,
                             const std::function<void(const Golden&, double)>& tell, bool keeps_light)
{
    std::vector<Result> results;
    for (const Golden& golden : goldens) {
        if (tell) tell(golden, double(results.size()) / double(goldens.size()));
        results.push_back(run(golden, options));
        Result& result = results.back();
        write_pictures(result, output);
        if (keeps_light && result.light) write_pfm(output / (golden.name + ".actual.pfm"), *result.light);
        result.light.reset();
    }
    return results;
}

/// The content of results.json.
std::string results_text(const std::vector<Result>& results)
{
    Json rows = Json::array();
    for (const Result& result : results) rows.push_back(json_of(result));
    return Json{{"shvr_golden_results", 1}, {"goldens", rows}}.dump(2) + "\n";
}

void write_all(Outcome& outcome, const fs::path& output)
{
    outcome.failed = failures_of(outcome.results);
    report::write_text(output / "results.json", results_text(outcome.results));
    write_reports(outcome, output);
}

/// Appends the results in a file that `results_text` made, with their pictures in `output`.
void read_results(const fs::path& file, const fs::path& output, const std::string& pattern,
                  std::vector<Result>& results)
{
    const Json json = Json::parse(read_text(file, MAX_RESULTS_BYTES), nullptr, false);
    try {
        for (const Json& row : json.at("goldens"))
            if (matches(row.at("name"), pattern)) results.push_back(result_of(row, output));
    } catch (const Json::exception& error) {
        fail(file.string(), ": is not what shvr golden run writes: ", error.what());
    }
}

}  // namespace

Result run(const Golden& golden, const StudioOptions& options)
{
    Result result{.golden = golden};
    const auto begun = std::chrono::steady_clock::now();
    try {
        judge(result, options);
    } catch (const std::exception& error) {
        result.status = Status::broken;
        result.reason = error.what();
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return result;
}

Outcome run_all(const std::vector<Golden>& goldens, const fs::path& output, const StudioOptions& options,
                const std::function<void(const Golden&, double)>& tell, bool keeps_light)
{
    report::make_folder(output);
    Outcome outcome{.report = output / "report.html"};
    report::write_text(outcome.report,
                       report::page("SHVR goldens", "", "<h1>The run did not end: it crashed or was stopped.</h1>\n"));
    outcome.results = run_some(goldens, output, options, tell, keeps_light);
    write_all(outcome, output);
    return outcome;
}

void run_part(const std::vector<Golden>& goldens, const fs::path& output, const fs::path& results,
              const StudioOptions& options, const std::function<void(const Golden&, double)>& tell, bool keeps_light)
{
    report::make_folder(output);
    report::write_text(results, results_text(run_some(goldens, output, options, tell, keeps_light)));
}

Outcome join_parts(const std::vector<Golden>& goldens, const fs::path& output, const std::vector<fs::path>& results)
{
    std::vector<Result> found;
    for (const fs::path& file : results) read_results(file, output, "*", found);
    Outcome outcome{.report = output / "report.html"};
    for (const Golden& golden : goldens) {
        const auto result = std::ranges::find(found, golden.name, [](const Result& one) { return one.golden.name; });
        if (result == found.end())
            fail(golden.file().string(), ": is in the results of no task; expected the same goldens as the tasks had");
        outcome.results.push_back(std::move(*result));
    }
    write_all(outcome, output);
    return outcome;
}

Outcome read_run(const fs::path& output, const std::string& pattern)
{
    const fs::path file = output / "results.json";
    if (!is_file(file)) fail(file.string(), " is missing; expected what shvr golden run writes");
    Outcome outcome{.report = output / "report.html"};
    read_results(file, output, pattern, outcome.results);
    if (outcome.results.empty()) fail(file.string(), ": no golden is named ", in_quotes(pattern));
    outcome.failed = failures_of(outcome.results);
    return outcome;
}

void write_reports(const Outcome& outcome, const fs::path& output)
{
    report::write_text(output / "junit.xml", junit_of(outcome.results));
    report::write_text(outcome.report, page_of(outcome.results));
}

Json json_of(const Result& result)
{
    const Golden& golden = result.golden;
    Json metrics;
    if (const auto& difference = result.difference)
        metrics = {{"max_abs", difference->max_abs},
                   {"rmse", difference->rmse},
                   {"alpha_rmse", difference->alpha_rmse},
                   {"psnr_db", difference->psnr_db ? Json(*difference->psnr_db) : Json(nullptr)},
                   {"ssim", difference->ssim},
                   {"flip_mean", difference->flip_mean},
                   {"flip_p99", difference->flip_p99},
                   {"mean_error", difference->mean_error},
                   {"fraction_over_1", difference->fraction_over_1},
                   {"fraction_over_4", difference->fraction_over_4}};
    Json drawn_by;
    if (const auto& maker = result.maker)
        drawn_by = {{"device", maker->device},
                    {"driver", maker->driver},
                    {"processor", maker->processor},
                    {"instructions", maker->instructions}};
    const Json blessed = result.side_car.empty() ? Json(nullptr) : Json::parse(result.side_car, nullptr, false);
    return {{"name", golden.name},
            {"folder", golden.folder.string()},
            {"why", golden.why},
            {"class", spelled(golden.strictness)},
            {"loosened", golden.loosened},
            {"status", spelled(result.status)},
            {"reason", result.reason},
            {"seconds", result.seconds},
            {"metrics", metrics},
            {"drawn_by", drawn_by},
            {"blessed", blessed.is_discarded() ? Json(nullptr) : blessed},
            {"bless", bless_command(golden)}};
}

}  // namespace shvr::golden
