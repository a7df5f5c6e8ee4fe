#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

namespace {

/// All reports of the passes that share a name, frame by frame. Frames in which no such pass ran have no report.
struct PassHistory {
    std::vector<double> times, records;
    size_t count = 0;
    gpu::PassReport last;
};

std::vector<PassHistory> histories_of(const std::vector<ProfiledFrame>& frames)
{
    std::vector<PassHistory> histories;  // in order of first appearance
    for (const ProfiledFrame& frame : frames)
        for (const gpu::PassReport& report : frame.passes) {
            auto found = std::find_if(histories.begin(), histories.end(),
                                      [&](const PassHistory& history) { return history.last.name == report.name; });
            if (found == histories.end()) found = histories.emplace(histories.end());
            if (report.timed) found->times.push_back(report.gpu_ms);
            found->records.push_back(report.record_ms);
            ++found->count;
            found->last = report;
        }
    return histories;
}

Json or_null(const std::optional<Spread>& spread, double Spread::*member)
{
    return spread ? Json((*spread).*member) : Json(nullptr);
}

Json pass_summary(const PassHistory& history)
{
    const std::optional<Spread> spread = spread_of(history.times), record = spread_of(history.records);
    return {{"name", history.last.name},
            {"kernel", history.last.kernel},
            {"count", history.count},
            {"min_ms", or_null(spread, &Spread::minimum)},
            {"median_ms", or_null(spread, &Spread::median)},
            {"p95_ms", or_null(spread, &Spread::p95)},
            {"max_ms", or_null(spread, &Spread::maximum)},
            {"record_min_ms", or_null(record, &Spread::minimum)},
            {"record_median_ms", or_null(record, &Spread::median)},
            {"record_p95_ms", or_null(record, &Spread::p95)},
            {"bytes", history.last.bytes},
            {"gb_per_s", spread && spread->median > 0.0 ? Json(double(history.last.bytes) / (spread->median * 1e6))
                                                        : Json(nullptr)},
            {"dispatches", history.last.dispatches},
            {"barrier", history.last.barrier}};
}

/// Returns, for each frame, the sum over its passes. Frames without times are omitted.
std::vector<double> sums_of(const std::vector<ProfiledFrame>& frames)
{
    std::vector<double> sums;
    for (const ProfiledFrame& frame : frames) {
        double sum = 0.0;
        bool timed = !frame.passes.empty();
        for (const gpu::PassReport& report : frame.passes) sum += report.gpu_ms, timed = timed && report.timed;
        if (timed) sums.push_back(sum);
    }
    return sums;
}

/// Returns the invocations of each kernel pass; null if the device does not report them.
Json invocations_of(const std::vector<gpu::PassReport>& passes)
{
    Json invocations = Json::object();
    for (const gpu::PassReport& pass : passes)
        if (!pass.kernel.empty()) invocations[pass.name] = pass.invocations ? Json(*pass.invocations) : Json(nullptr);
    return invocations;
}

std::string mebibytes_text(const Json& bytes)
{
    return sentence(std::fixed, std::setprecision(1), bytes.get<double>() / double(1 << 20));
}

Json memory_summary(const Profile& profile)
{
    Json memory = frame_memory_of(profile.graph);
    memory["device_budget"] = profile.device_budget;
    memory["host_budget"] = profile.host_budget;
    return memory;
}

std::string of_budget(const Json& used, const Json& peak, const Json& budget)
{
    return sentence(mebibytes_text(used), " MiB, at most ", mebibytes_text(peak), " of a budget of ",
                    mebibytes_text(budget));
}

std::string memory_text(const Json& bytes, const Json& memory)
{
    std::vector<std::vector<std::string>> rows{{"resource of the frame", "KiB", "format", "first pass", "last pass"}};
    for (const Json& one : memory["resources"]) {
        const std::string format = one["format"].is_null() ? "buffer" : one["format"].get<std::string>();
        const bool lasting = one["lasting"].get<bool>();
        rows.push_back({one["name"], sentence(std::fixed, std::setprecision(1), one["bytes"].get<double>() / 1024.0),
                        format, lasting ? "(outlives the frame)" : one["first_pass"].get<std::string>(),
                        one["last_pass"]});
    }
    const auto kibibytes = [&](const char* key) {
        return sentence(std::fixed, std::setprecision(1), memory[key].get<double>() / 1024.0);
    };
    return sentence("device memory: ", of_budget(bytes["device"], bytes["peak_device"], memory["device_budget"]),
                    "\nhost memory: ", of_budget(bytes["host"], bytes["peak_host"], memory["host_budget"]), "\n\n",
                    table_text(rows), "\ntransient resources: ", kibibytes("transient_bytes"), " KiB in ",
                    kibibytes("transient_taken"), " KiB of memory (", std::fixed, std::setprecision(0),
                    100.0 * memory["sharing_saves"].get<double>(), " % less); packed as one block ",
                    kibibytes("transient_packed"), ", and never below ", kibibytes("transient_most_at_once"),
                    ", which one step needs\n");
}

}  // namespace

std::optional<Spread> spread_of(std::vector<double> values)
{
    if (values.empty()) return std::nullopt;
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    const auto rank = size_t(std::ceil(0.95 * double(n)));
    return Spread{values.front(), (values[(n - 1) / 2] + values[n / 2]) / 2.0, values[rank - 1], values.back()};
}

Json summary_of(const Profile& profile)
{
    Json passes = Json::array();
    for (const PassHistory& history : histories_of(profile.frames)) passes.push_back(pass_summary(history));
    Json first_frame = Json::array();
    for (const gpu::PassReport& report : profile.first_frame)
        first_frame.push_back({{"name", report.name}, {"gpu_ms", report.timed ? Json(report.gpu_ms) : Json(nullptr)}});
    std::vector<double> walls;
    for (const ProfiledFrame& frame : profile.frames) walls.push_back(frame.wall_ms);
    const std::optional<Spread> wall = spread_of(walls), sum = spread_of(sums_of(profile.frames));
    return {{"input", profile.input},
            {"device", profile.device},
            {"driver", profile.driver},
            {"size", {profile.size.x, profile.size.y}},
            {"frames", profile.frames.size()},
            {"warmup", profile.warmup},
            {"serialize", profile.serialize},
            {"timed", sum.has_value()},
            {"complete", profile.complete},
            {"voxels_not_read", profile.voxels_not_read},
            {"passes", passes},
            {"first_frame", first_frame},
            {"frame_min_ms", or_null(wall, &Spread::minimum)},
            {"frame_median_ms", or_null(wall, &Spread::median)},
            {"frame_p95_ms", or_null(wall, &Spread::p95)},
            {"frame_max_ms", or_null(wall, &Spread::maximum)},
            {"sum_median_ms", or_null(sum, &Spread::median)},
            {"counters", counters_of(profile.counted)},
            {"invocations", invocations_of(profile.counted)},
            {"bytes", profile.bytes},
            {"memory", memory_summary(profile)},
            {"warnings", profile.warnings}};
}

std::string number_text(const Json& value)
{
    if (!value.is_number()) return "-";
    return sentence(std::fixed, std::setprecision(3), value.get<double>());
}

std::string table_text(const std::vector<std::vector<std::string>>& rows)
{
    std::vector<size_t> widths;
    for (const std::vector<std::string>& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    for (const std::vector<std::string>& row : rows) {
        for (size_t i = 0; i < row.size(); ++i) {
            const std::string padding(widths[i] - row[i].size(), ' ');
            if (i > 0) text += "  ";
            text += i == 0 ? row[i] + padding : padding + row[i];
        }
        text.erase(text.find_last_not_of(' ') + 1);
        text += '\n';
    }
    return text;
}

std::string text_of(const Json& summary)
{
    std::vector<std::vector<std::string>> rows{{"pass", "count", "min ms", "median ms", "p95 ms", "max ms", "record us",
                                                "MiB bound", "dispatches", "barrier"}};
    for (const Json& pass : summary["passes"])
        rows.push_back({pass["name"], pass["count"].dump(), number_text(pass["min_ms"]), number_text(pass["median_ms"]),
                        number_text(pass["p95_ms"]), number_text(pass["max_ms"]),
                        sentence(std::fixed, std::setprecision(1), 1000.0 * pass["record_median_ms"].get<double>()),
                        mebibytes_text(pass["bytes"]), pass["dispatches"].dump(), pass["barrier"]});
    rows.push_back({"sum of passes", "", "", number_text(summary["sum_median_ms"])});
    rows.push_back({"frame", summary["frames"].dump(), number_text(summary["frame_min_ms"]),
                    number_text(summary["frame_median_ms"]), number_text(summary["frame_p95_ms"]),
                    number_text(summary["frame_max_ms"])});
    std::vector<std::vector<std::string>> first{{"first frame", "ms"}};
    for (const Json& pass : summary["first_frame"]) first.push_back({pass["name"], number_text(pass["gpu_ms"])});
    std::vector<std::vector<std::string>> work{{"work", "per frame"}};
    for (const auto& [name, value] : summary["counters"].items()) work.push_back({name, value.dump()});
    for (const auto& [name, value] : summary["invocations"].items())
        if (!value.is_null()) work.push_back({"invocations of " + name, value.dump()});
    return sentence(summary["device"].get<std::string>(), ", ", summary["driver"].get<std::string>(), ", ",
                    summary["size"][0], " x ", summary["size"][1], " pixels\n\n", table_text(rows), "\n",
                    table_text(first), "\n", table_text(work), "\n", memory_text(summary["bytes"], summary["memory"]));
}

}  // namespace shvr::cli
