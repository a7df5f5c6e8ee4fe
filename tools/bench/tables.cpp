// Writes the tables of the bench's results as CSV.

#include <algorithm>
#include <iomanip>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "tools/bench/peer.h"
#include "tools/bench/results.h"

namespace shvr::bench {

namespace {

constexpr double EQUAL_ERRORS[] = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4};

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

}  // namespace

std::string csv_of(const Results& results)
{
    std::string text =
        "scene,run,family,settings,scale,rmse,max_abs,alpha_rmse,alpha_max_abs,psnr_db,ssim,flip_mean,flip_p99,"
        "fraction_over_1,fraction_over_4,min_ms,median_ms,median_low_ms,median_high_ms,p95_ms,first_ms,device_bytes,on_"
        "front";
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
            text += sentence(
                cell(scene.name), ",", cell(run.name), ",", cell(run.family), ",", cell(settings), ",",
                digits_of(run.scale), ",", digits_of(error.rmse), ",", digits_of(error.max_abs), ",",
                digits_of(error.alpha_rmse), ",", digits_of(error.alpha_max_abs), ",",
                error.psnr_db ? digits_of(*error.psnr_db) : std::string(), ",", digits_of(error.ssim), ",",
                digits_of(error.flip_mean), ",", digits_of(error.flip_p99), ",", digits_of(error.fraction_over_1), ",",
                digits_of(error.fraction_over_4), ",", digits_of(run.time.min_ms), ",", digits_of(run.time.median_ms),
                ",", digits_of(run.time.low_ms), ",", digits_of(run.time.high_ms), ",", digits_of(run.time.p95_ms), ",",
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
            if (is_peer(run.family)) continue;  // other machines may lack the peer, and its work is not counted
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

}  // namespace shvr::bench
