// The page of a profile: frames and passes along an axis of time, memory below them, and the tables.

#include <algorithm>
#include <cmath>
#include <iomanip>

#include "engine/pages/html.h"
#include "tools/cli/profile/chart.h"
#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

namespace {

using report::escaped;

constexpr double NAMES = 110.0, NAMES_OF_RESOURCES = 330.0;
constexpr const char *FRAME_COLOR = "#8b9096", *RECORD_COLOR = "#b07aa1", *OWN_COLOR = "#0072b2",
                     *LASTING_COLOR = "#9aa0a6";

std::string ms_text(double ms)
{
    return sentence(std::setprecision(4), ms, " ms");
}

std::string about(const gpu::PassReport& pass, size_t frame)
{
    return sentence(pass.name, ", frame ", frame, ": ", ms_text(pass.gpu_ms), ", ", pass.dispatches,
                    pass.dispatches == 1 ? " dispatch" : " dispatches",
                    pass.barrier.empty() ? "" : ", after a barrier " + pass.barrier);
}

PassColors colors_of(const Json& summary)
{
    std::vector<std::string> names;
    for (const Json& pass : summary["passes"]) names.push_back(pass["name"]);
    return PassColors(names);
}

/// Adds the frames [first, end) to a chart whose axis begins at the time `begin_ms` of the frames' clock.
void add_frames(Chart& chart, const Profile& profile, const PassColors& colors, size_t first, size_t end,
                double begin_ms)
{
    chart.begin_row("host: frames");
    for (size_t i = first; i < end; ++i) {
        const ProfiledFrame& frame = profile.frames[i];
        chart.bar(frame.begin_ms - begin_ms, frame.end_ms - frame.begin_ms, FRAME_COLOR,
                  sentence("frame ", i, ": ", ms_text(frame.end_ms - frame.begin_ms), ", of these ",
                           ms_text(frame.wall_ms), " from submission to the end"),
                  sentence("frame ", i));
    }
    chart.begin_row("host: recording");
    for (size_t i = first; i < end; ++i) {
        const ProfiledFrame& frame = profile.frames[i];
        const std::vector<std::pair<double, double>> recorded = recorded_in(profile, frame);
        for (size_t pass = 0; pass < recorded.size(); ++pass)
            chart.bar(recorded[pass].first - begin_ms, recorded[pass].second, RECORD_COLOR,
                      sentence("recording ", frame.passes[pass].name, ", frame ", i, ": ",
                               ms_text(frame.passes[pass].record_ms)));
    }
    chart.begin_row("device: passes");
    for (const PlacedPass& placed : placed_passes(profile)) {
        if (placed.frame < first || placed.frame >= end) continue;
        const gpu::PassReport& pass = profile.frames[placed.frame].passes[placed.pass];
        chart.bar(placed.begin_ms - begin_ms, pass.gpu_ms, colors.of(pass.name), about(pass, placed.frame), pass.name,
                  placed.lane);
    }
}

std::string all_frames(const Profile& profile, const PassColors& colors)
{
    double end = 0.0;
    uint64_t most = 0;
    std::vector<std::pair<double, double>> memory;
    for (const ProfiledFrame& frame : profile.frames) {
        end = std::max(end, frame.end_ms);
        most = std::max(most, frame.device_bytes);
        memory.emplace_back(frame.end_ms, double(frame.device_bytes));
    }
    Chart chart(NAMES, end);
    add_frames(chart, profile, colors, 0, profile.frames.size(), 0.0);
    chart.line("device memory", memory, bytes_text(most));
    return chart.svg();
}

/// The median frame, enlarged.
std::string median_frame(const Profile& profile, const PassColors& colors)
{
    std::vector<size_t> order(profile.frames.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, {}, [&](size_t i) { return profile.frames[i].wall_ms; });
    const size_t middle = order[(order.size() - 1) / 2];
    const ProfiledFrame& frame = profile.frames[middle];
    Chart chart(NAMES, frame.end_ms - frame.begin_ms);
    add_frames(chart, profile, colors, middle, middle + 1, frame.begin_ms);
    return sentence("<h2>The median frame: frame ", middle, "</h2>\n", chart.svg());
}

/// Returns the text of a table cell: "-" for null; the digits of integers are grouped.
std::string cell_of(const Json& value)
{
    return value.is_string()           ? escaped(value.get<std::string>())
           : value.is_number_float()   ? number_text(value)
           : value.is_number_integer() ? grouped_text(value.get<int64_t>())
                                       : "-";
}

std::string passes_table(const Json& summary, const PassColors& colors)
{
    constexpr std::pair<const char*, const char*> COLUMNS[] = {
        {"count", "frames"},      {"min_ms", "min ms"},         {"median_ms", "median ms"},
        {"p95_ms", "p95 ms"},     {"max_ms", "max ms"},         {"record_median_ms", "recording ms"},
        {"bytes", "bytes bound"}, {"gb_per_s", "GB/s at most"}, {"dispatches", "dispatches"},
        {"barrier", "barrier"}};
    std::string rows = "<tr><th>pass</th><th>share</th>";
    for (const auto& [key, words] : COLUMNS) rows += sentence("<th>", words, "</th>");
    rows += "<th>threads</th></tr>\n";
    for (const Json& pass : summary["passes"]) {
        const std::string name = pass["name"];
        const bool has_share = pass["median_ms"].is_number() && summary["sum_median_ms"].is_number() &&
                               summary["sum_median_ms"].get<double>() > 0.0;
        rows += sentence("<tr><td><span class=\"swatch\" style=\"background:", colors.of(name), "\"></span>",
                         escaped(name), "</td><td>",
                         has_share ? sentence(std::lround(100.0 * pass["median_ms"].get<double>() /
                                                          summary["sum_median_ms"].get<double>()),
                                              " %")
                                   : std::string("-"),
                         "</td>");
        for (const auto& [key, words] : COLUMNS) rows += "<td>" + cell_of(pass[key]) + "</td>";
        rows += "<td>" + cell_of(summary["invocations"].value(name, Json())) + "</td></tr>\n";
    }
    return "<table>\n" + rows + "</table>\n";
}

/// Returns the table of work done once, in the first frame: uploads, the leap grid, ambient occlusion.
std::string first_frame_table(const Json& summary)
{
    std::string rows = "<tr><th>pass</th><th>ms</th></tr>\n";
    for (const Json& pass : summary["first_frame"])
        rows += "<tr><td>" + escaped(pass["name"].get<std::string>()) + "</td><td>" + cell_of(pass["gpu_ms"]) +
                "</td></tr>\n";
    return sentence("<details><summary>The first frame, which also prepares: ", summary["first_frame"].size(),
                    " passes</summary>\n<table>\n", rows, "</table>\n</details>\n");
}

std::string pairs_table(const Json& object)
{
    std::string rows;
    for (const auto& [name, value] : object.items())
        rows += "<tr><td>" + escaped(name) + "</td><td>" + cell_of(value) + "</td></tr>\n";
    return "<table>\n" + rows + "</table>\n";
}

/// Draws a bar for each resource, from the first to the last step that uses the resource.
std::string lifetimes_of(const Json& memory)
{
    const double steps = memory["steps"];
    Chart chart(NAMES_OF_RESOURCES, steps);
    for (const Json& one : memory["resources"]) {
        const bool lasting = one["lasting"].get<bool>();
        const double first = lasting ? 0.0 : one["first_step"].get<double>();
        const double end = lasting ? steps : one["last_step"].get<double>() + 1.0;
        const std::string name = one["name"].get<std::string>();
        chart.begin_row(sentence(name, ", ", bytes_text(one["bytes"].get<uint64_t>())));
        chart.bar(first, end - first, lasting ? LASTING_COLOR : OWN_COLOR,
                  sentence(name, lasting ? ": outlives the frame, used from " : ": from ",
                           one["first_pass"].get<std::string>(), " to ", one["last_pass"].get<std::string>()),
                  lasting
                      ? std::string()
                      : sentence(one["first_pass"].get<std::string>(), " to ", one["last_pass"].get<std::string>()));
    }
    std::string list;
    for (const Json& step : memory["step_names"]) list += (list.empty() ? "" : ", ") + step.get<std::string>();
    return chart.svg("", 1.0) +
           sentence(
               "<p>Blue: what this frame alone needs, from its first pass to its last. Grey: what outlives it. "
               "Steps, from 0: ",
               escaped(list), ".</p>\n");
}

/// Returns the totals of a memory section, as text.
Json totals_of(const Json& summary)
{
    const Json &bytes = summary["bytes"], &memory = summary["memory"];
    return {{"device, now", bytes["device"]},
            {"device, at most", bytes["peak_device"]},
            {"device, budget", memory["device_budget"]},
            {"host, now", bytes["host"]},
            {"host, at most", bytes["peak_host"]},
            {"host, budget", memory["host_budget"]},
            {"what this frame alone needs: each resource by itself", memory["transient_bytes"]},
            {"with equal ones in the same memory, as it is done", memory["transient_taken"]},
            {"packed as one block", memory["transient_packed"]},
            {"what one of its steps needs, and no sharing goes below", memory["transient_most_at_once"]}};
}

}  // namespace

std::string page_of(const Profile& profile)
{
    const Json summary = summary_of(profile);
    const PassColors colors = colors_of(summary);
    std::string warnings;
    for (const std::string& warning : profile.warnings) warnings += "<p>" + escaped(warning) + "</p>\n";
    return report::page(
        "SHVR profile", CHART_STYLE,
        sentence("<h1>Where a frame's time goes</h1>\n<p>", escaped(profile.input), ", ", profile.size.x, " x ",
                 profile.size.y, " pixels, ", profile.frames.size(), " frames after ", profile.warmup, " to warm up; ",
                 escaped(profile.driver), profile.serialize ? "; a full barrier between passes" : "", "</p>\n",
                 warnings, passes_table(summary, colors), "<p>A frame takes ", number_text(summary["frame_median_ms"]),
                 " ms from its submission to its end (median; ", number_text(summary["frame_min_ms"]), " to ",
                 number_text(summary["frame_p95_ms"]), ", p95), its passes together ",
                 number_text(summary["sum_median_ms"]), " ms.</p>\n", first_frame_table(summary),
                 "<h2>All frames</h2>\n", all_frames(profile, colors),
                 "<p>Host and device have clocks of their own: passes are drawn to end with their frame. What is under "
                 "the pointer says what it is.</p>\n",
                 median_frame(profile, colors), "<h2>Work of one frame</h2>\n", pairs_table(summary["counters"]),
                 "<h2>Device memory by resource, bytes</h2>\n", pairs_table(summary["bytes"]["by_resource"]),
                 "<h2>Memory of one frame, step by step</h2>\n", lifetimes_of(summary["memory"]),
                 "<h2>Memory against its budgets, bytes</h2>\n", pairs_table(totals_of(summary))));
}

}  // namespace shvr::cli
