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

namespace shvr::bench {

namespace {

using Json = nlohmann::ordered_json;
constexpr int64_t MAX_BENCH_BYTES = int64_t{64} << 20;
constexpr int SCHEMA = 1;
constexpr double ERROR_MARGIN = 1.01;
constexpr double LEAST_ERROR = 1e-7;  // of a float
constexpr double EQUAL_ERRORS[] = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4};

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
              {"psnr_db", error.psnr_db ? Json(*error.psnr_db) : Json(nullptr)},
              {"ssim", error.ssim},
              {"flip_mean", error.flip_mean},
              {"flip_p99", error.flip_p99}}},
            {"min_ms", run.time.min_ms},
            {"median_ms", run.time.median_ms},
            {"p95_ms", run.time.p95_ms},
            {"first_ms", run.first_ms},
            {"work", work},
            {"device_bytes", run.device_bytes},
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
                 .psnr_db = {},
                 .ssim = error.at("ssim"),
                 .flip_mean = error.at("flip_mean"),
                 .flip_p99 = error.at("flip_p99")};
    if (!error.at("psnr_db").is_null()) run.error.psnr_db = error.at("psnr_db").get<double>();
    run.time = {json.at("min_ms"), json.at("median_ms"), json.at("p95_ms")};
    run.first_ms = json.at("first_ms");
    for (const auto& [name, value] : json.at("work").items()) run.work.emplace_back(name, value.get<uint64_t>());
    run.device_bytes = json.at("device_bytes");
    run.on_front = json.at("on_front");
    return run;
}

/// Quoted, since names may hold commas.
std::string cell(const std::string& text)
{
    std::string quoted = "\"";
    for (const char character : text) quoted += character == '"' ? std::string("\"\"") : std::string(1, character);
    return quoted + "\"";
}

template <class Accept, class Better>
const Measured* best(const SceneResult& scene, const std::string& family, const Accept& accept, const Better& better)
{
    const Measured* found = nullptr;
    for (const Measured& run : scene.runs)
        if (run.family == family && accept(run) && (!found || better(run, *found))) found = &run;
    return found;
}

uint64_t counted(const Measured& run, const char* name)
{
    const auto found = std::ranges::find(run.work, name, &std::pair<std::string, uint64_t>::first);
    return found == run.work.end() ? 0 : found->second;
}

std::vector<std::string> families_of(const SceneResult& scene)
{
    std::vector<std::string> families;
    for (const Measured& run : scene.runs)
        if (std::ranges::find(families, run.family) == families.end()) families.push_back(run.family);
    return families;
}

void compare_runs(const std::string& scene, const Measured& a, const Measured& b, bool with_work, bool with_times,
                  std::vector<Change>& changes)
{
    const auto add = [&](const std::string& what, double from, double to, double noise, bool is_worse) {
        if (from != to) changes.push_back({scene, a.name, what, from, to, noise, is_worse});
    };
    const auto error = [&](const char* what, double from, double to) {
        if (to > from * ERROR_MARGIN + LEAST_ERROR || from > to * ERROR_MARGIN + LEAST_ERROR)
            add(what, from, to, 0.0, to > from);
    };
    error("rmse", a.error.rmse, b.error.rmse);
    error("max_abs", a.error.max_abs, b.error.max_abs);
    for (const auto& [name, value] : b.work) {
        const auto before = std::ranges::find(a.work, name, &std::pair<std::string, uint64_t>::first);
        if (before == a.work.end() || !with_work) continue;
        // Bricks that are skipped and rays that end early are work that is saved.
        const bool saves = name == "bricks_skipped" || name == "rays_terminated_early" || name == "leaps";
        add(name, double(before->second), double(value), 0.0, !saves && value > before->second);
    }
    if (!with_times) return;
    const double noise = std::hypot(a.time.noise_ms(), b.time.noise_ms());
    if (std::abs(b.time.median_ms - a.time.median_ms) > noise)
        add("median_ms", a.time.median_ms, b.time.median_ms, noise, b.time.median_ms > a.time.median_ms);
}

}  // namespace

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
        scenes.push_back({{"name", scene.name},
                          {"what", scene.what},
                          {"volume", scene.volume},
                          {"reference_seconds", scene.reference_seconds},
                          {"notes", scene.notes},
                          {"runs", runs}});
    }
    return {{"shvr_bench", SCHEMA},
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
    const Json json = Json::parse(read_text(file, MAX_BENCH_BYTES), nullptr, false);
    if (!json.is_object() || json.value("shvr_bench", 0) != SCHEMA)
        fail(file.string(), ": is no bench.json of version ", SCHEMA, "; expected what shvr bench writes");
    try {
        Results results{.device = json.at("device"), .driver = json.at("driver"), .processor = json.at("processor")};
        results.instructions = json.at("instructions");
        results.cores = json.at("cores");
        results.load = json.at("load");
        results.rounds = json.at("rounds");
        results.width = json.at("size").at(0);
        results.height = json.at("size").at(1);
        for (const Json& scene : json.at("scenes")) {
            results.scenes.push_back(
                {scene.at("name"), scene.at("what"), scene.at("volume"), scene.at("reference_seconds"), {}});
            results.scenes.back().notes = scene.value("notes", std::vector<std::string>());
            for (const Json& run : scene.at("runs")) results.scenes.back().runs.push_back(measured_of(run));
        }
        results.left_out = json.value("left_out", std::vector<std::string>());
        return results;
    } catch (const Json::exception& error) {
        fail(file.string(), ": is not what shvr bench writes: ", error.what());
    }
}

std::string csv_of(const Results& results)
{
    std::string text =
        "scene,run,family,settings,scale,rmse,max_abs,psnr_db,ssim,flip_mean,flip_p99,min_ms,median_ms,"
        "p95_ms,first_ms,device_bytes,on_front";
    std::vector<std::string> names;
    for (const SceneResult& scene : results.scenes)
        for (const Measured& run : scene.runs)
            for (const auto& [name, value] : run.work)
                if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    for (const std::string& name : names) text += "," + name;
    text += "\n";
    for (const SceneResult& scene : results.scenes)
        for (const Measured& run : scene.runs) {
            std::string settings;
            for (const std::string& setting : run.settings) settings += (settings.empty() ? "" : " ") + setting;
            const Error& error = run.error;
            text +=
                sentence(cell(scene.name), ",", cell(run.name), ",", cell(run.family), ",", cell(settings), ",",
                         digits_of(run.scale), ",", digits_of(error.rmse), ",", digits_of(error.max_abs), ",",
                         error.psnr_db ? digits_of(*error.psnr_db) : std::string(), ",", digits_of(error.ssim), ",",
                         digits_of(error.flip_mean), ",", digits_of(error.flip_p99), ",", digits_of(run.time.min_ms),
                         ",", digits_of(run.time.median_ms), ",", digits_of(run.time.p95_ms), ",",
                         digits_of(run.first_ms), ",", run.device_bytes, ",", run.on_front ? 1 : 0);
            for (const std::string& name : names) {
                const auto found = std::ranges::find(run.work, name, &std::pair<std::string, uint64_t>::first);
                text += found == run.work.end() ? "," : sentence(",", found->second);
            }
            text += "\n";
        }
    return text;
}

std::string front_csv(const Results& results)
{
    std::string text = "scene,run,family,settings,samples,reads,rmse\n";
    for (const SceneResult& scene : results.scenes)
        for (const Measured& run : scene.runs) {
            if (is_peer(run.family)) continue;  // whether it is there differs, and its work is not known
            std::string settings;
            for (const std::string& setting : run.settings) settings += (settings.empty() ? "" : " ") + setting;
            text += sentence(cell(scene.name), ",", cell(run.name), ",", cell(run.family), ",", cell(settings), ",",
                             counted(run, "samples"), ",", counted(run, "density_reads"), ",", std::setprecision(5),
                             run.error.rmse, "\n");
        }
    return text;
}

std::string equal_error_csv(const Results& results)
{
    std::string text = "scene,rmse_at_most,family,run,median_ms,rmse\n";
    for (const SceneResult& scene : results.scenes)
        for (const double limit : EQUAL_ERRORS)
            for (const std::string& family : families_of(scene)) {
                const Measured* run = best(
                    scene, family, [&](const Measured& r) { return r.error.rmse <= limit; },
                    [](const Measured& a, const Measured& b) { return a.time.median_ms < b.time.median_ms; });
                if (run)
                    text += sentence(cell(scene.name), ",", limit, ",", cell(family), ",", cell(run->name), ",",
                                     digits_of(run->time.median_ms), ",", digits_of(run->error.rmse), "\n");
            }
    return text;
}

std::string equal_time_csv(const Results& results)
{
    std::string text = "scene,quality,ms_at_most,family,run,median_ms,rmse\n";
    for (const SceneResult& scene : results.scenes)
        for (const Measured& quality : scene.runs) {
            if (quality.family != "quality") continue;
            for (const std::string& family : families_of(scene)) {
                const Measured* run = best(
                    scene, family, [&](const Measured& r) { return r.time.median_ms <= quality.time.median_ms; },
                    [](const Measured& a, const Measured& b) { return a.error.rmse < b.error.rmse; });
                if (run)
                    text += sentence(cell(scene.name), ",", cell(quality.name), ",", digits_of(quality.time.median_ms),
                                     ",", cell(family), ",", cell(run->name), ",", digits_of(run->time.median_ms), ",",
                                     digits_of(run->error.rmse), "\n");
            }
        }
    return text;
}

std::vector<AtPeersError> at_peers_errors(const Results& results)
{
    std::vector<AtPeersError> rows;
    for (const SceneResult& scene : results.scenes)
        for (const Measured& peer : scene.runs) {
            if (!is_peer(peer.family)) continue;
            AtPeersError row{.scene = scene.name, .peer = &peer};
            for (const Measured& run : scene.runs) {
                if (is_peer(run.family)) continue;
                const bool is_near = run.error.rmse <= peer.error.rmse;
                if (is_near && (!row.fastest || run.time.median_ms < row.fastest->time.median_ms)) row.fastest = &run;
                // "step 0.5" of "VTK step 0.5".
                if (run.family == "step" && peer.name.ends_with(" " + run.name)) row.same_step = &run;
            }
            rows.push_back(row);
        }
    return rows;
}

std::string equal_peer_csv(const Results& results)
{
    std::string text =
        "scene,peer,peer_ms,peer_rmse,run,median_ms,rmse,time_ratio,same_step_ms,same_step_rmse,same_step_ratio\n";
    for (const AtPeersError& row : at_peers_errors(results)) {
        const double peer_ms = row.peer->time.median_ms;
        text += sentence(cell(row.scene), ",", cell(row.peer->name), ",", digits_of(peer_ms), ",",
                         digits_of(row.peer->error.rmse), ",", cell(row.fastest ? row.fastest->name : "none"));
        for (const Measured* const run : {row.fastest, row.same_step}) {
            const double ms = run ? run->time.median_ms : 0.0;
            text += run ? sentence(",", digits_of(ms), ",", digits_of(run->error.rmse), ",",
                                   peer_ms > 0.0 ? digits_of(ms / peer_ms) : std::string())
                        : ",,,";
        }
        text += "\n";
    }
    return text;
}

std::vector<Change> compare(const Results& a, const Results& b, bool with_times)
{
    std::vector<Change> changes;
    size_t common = 0;
    const bool with_work = a.driver == b.driver && a.instructions == b.instructions;
    for (const SceneResult& scene : a.scenes) {
        const auto other = std::ranges::find(b.scenes, scene.name, &SceneResult::name);
        if (other == b.scenes.end()) continue;
        for (const Measured& run : scene.runs) {
            const auto found = std::ranges::find(other->runs, run.name, &Measured::name);
            if (found == other->runs.end() || found->settings != run.settings) continue;
            ++common;
            compare_runs(scene.name, run, *found, with_work, with_times, changes);
        }
    }
    if (common == 0) fail("the two files have no run of a scene in common; expected results of the same scenes");
    std::ranges::stable_sort(changes, std::greater<>(), &Change::is_regression);
    return changes;
}

}  // namespace shvr::bench
