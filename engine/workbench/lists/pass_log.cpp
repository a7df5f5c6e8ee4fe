#include "engine/workbench/lists/pass_log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/session/fields.h"

namespace shvr::ui {

namespace {

constexpr int64_t MAX_RUN_BYTES = int64_t{16} << 20;
constexpr size_t MAX_PASSES = 10000;

struct SavedPass : View::PassTime {};
void fields(Fields& f, SavedPass& pass)
{
    static const NumberRange MILLISECONDS{0.0, 1e12};
    f.text("name", pass.name, {.is_required = true});
    f.whole("runs", pass.runs, 0, int64_t{1} << 53, {});
    f.number("total_ms", pass.total_ms, MILLISECONDS, {});
    f.number("longest_ms", pass.longest_ms, MILLISECONDS, {});
}

/// Reads a pass from the output of `shvr profile`, which states times per frame.
View::PassTime of_profile(const JsonNode& node)
{
    View::PassTime pass{.name = node["name"].text(), .runs = 1};
    const JsonNode median = node["median_ms"];
    if (median.is_number()) pass.total_ms = pass.longest_ms = median.number({0.0, 1e12});
    return pass;
}

}  // namespace

const View::PassTime* PassRun::find(const std::string& pass) const
{
    const auto found = std::ranges::find(passes, pass, &View::PassTime::name);
    return found == passes.end() ? nullptr : &*found;
}

PassRun read_pass_run(const std::filesystem::path& file)
{
    const JsonDocument document = read_json(
        file, MAX_RUN_BYTES, {.depth = 16, .expected = "saved GPU passes, or what shvr profile --json prints"});
    PassRun run{.name = file.filename().string()};
    const JsonNode root = document.root();
    run.is_of_profile = root["driver"].exists();
    if (!run.is_of_profile) {
        std::vector<SavedPass> saved;
        read_fields(root, file.parent_path(),
                    [&](Fields& f) { f.list("passes", saved, MAX_PASSES, {.is_required = true}); });
        run.passes.assign(saved.begin(), saved.end());
        return run;
    }
    for (const JsonNode& pass : root["passes"].elements(0, MAX_PASSES)) run.passes.push_back(of_profile(pass));
    return run;
}

void save_pass_run(const std::filesystem::path& file, const std::vector<View::PassTime>& passes)
{
    std::vector<SavedPass> written;
    for (const View::PassTime& pass : passes) written.push_back({pass});
    const std::string text =
        write_fields(file.parent_path(), [&](Fields& f) { f.list("passes", written, MAX_PASSES, {}); }) + "\n";
    write_file_atomically(file, std::as_bytes(std::span(text)));
}

std::string change_in_words(const View::PassTime& pass, const PassRun& run)
{
    const View::PassTime* const was = run.find(pass.name);
    if (!was) return {};
    // Times near the clock's resolution have no reliable ratio, so they are not compared.
    constexpr double MIN_MS = 0.05;
    if (was->total_ms < MIN_MS || pass.total_ms < MIN_MS) return pass.total_ms == was->total_ms ? "same" : "tiny";
    char text[32];
    std::snprintf(text, sizeof text, "x %.2f", pass.total_ms / was->total_ms);
    return text;
}

void PassLog::note(double now_s, const std::vector<View::PassTime>& passes)
{
    if (is_frozen_) return;
    Frame frame{.at_s = now_s, .added_ms = {}};
    for (const View::PassTime& pass : passes) {
        const auto was = std::ranges::find(passes_, pass.name, &View::PassTime::name);
        // If a pass has run fewer times than before, its counters were reset because another picture has begun.
        const bool goes_on = was != passes_.end() && was->runs <= pass.runs && was->total_ms <= pass.total_ms;
        frame.added_ms[pass.name] = pass.total_ms - (goes_on ? was->total_ms : 0.0);
    }
    passes_ = passes;
    frames_.push_back(std::move(frame));
    while (frames_.size() > MAX_FRAMES) frames_.pop_front();
}

std::vector<float> PassLog::graph(const std::string& pass) const
{
    std::vector<float> graph;
    for (const Frame& frame : frames_) {
        double sum = 0.0;
        for (const auto& [name, ms] : frame.added_ms)
            if (pass.empty() || pass == name) sum += ms;
        graph.push_back(float(sum));
    }
    return graph;
}

double PassLog::seconds() const
{
    return frames_.empty() ? 0.0 : frames_.back().at_s - frames_.front().at_s;
}

}  // namespace shvr::ui
