// The page of a session of work: actions and memory along a common axis of time, and the tables.

#include <algorithm>

#include "engine/pages/html.h"
#include "tools/cli/profile/chart.h"
#include "tools/cli/profile/profile_session.h"

namespace shvr::cli {

namespace {

constexpr const char *SKETCH_COLOR = "#e69f00", *SHARP_COLOR = "#56b4e9", *PAINT_COLOR = "#cc79a7",
                     *REST_COLOR = "#9aa0a6";

/// Returns a median with its spread, "12.3 (11.9 to 14.0)"; without the spread if there is only one replay.
std::string time_cell(const Json& action, const char* key, size_t replays)
{
    const Json& spread = action["over_replays"][key];
    if (replays == 1 || spread.is_null()) return number_text(action[key]);
    return sentence(number_text(spread["median"]), " (", number_text(spread["min"]), " to ", number_text(spread["p95"]),
                    ")");
}

std::string actions_table(const Json& summary)
{
    constexpr std::pair<const char*, const char*> COLUMNS[] = {
        {"paint_ms", "to paint, ms"},    {"sketch_ms", "to sketch, ms"},
        {"sharp_ms", "to sharp, ms"},    {"submits", "submits"},
        {"uploads", "uploads"},          {"allocations", "allocations"},
        {"evictions", "evictions"},      {"voxels_painted", "voxels painted"},
        {"device_bytes", "device bytes"}};
    std::string rows = "<tr><th>line: action</th>";
    for (const auto& [key, words] : COLUMNS) rows += sentence("<th>", words, "</th>");
    rows += "</tr>\n";
    for (const Json& one : summary["actions"]) {
        rows +=
            sentence("<tr><td>", one["line"].dump(), ": ", report::escaped(one["action"].get<std::string>()), "</td>");
        for (const auto& [key, words] : COLUMNS)
            rows += "<td>" +
                    (one[key].is_number_integer() ? grouped_text(one[key].get<int64_t>())
                                                  : time_cell(one, key, summary["replays"])) +
                    "</td>";
        rows += "</tr>\n";
    }
    return "<table>\n" + rows + "</table>\n";
}

std::string whole_table(const Json& summary)
{
    std::string rows =
        "<tr><th>the whole script</th><th>min ms</th><th>median ms</th><th>p95 ms</th><th>max ms</th></tr>\n";
    for (const auto& [key, words] : WHOLE_SCRIPT) {
        rows += sentence("<tr><td>", words, "</td>");
        for (const char* value : {"min", "median", "p95", "max"})
            rows += "<td>" + number_text(summary["whole"][key][value]) + "</td>";
        rows += "</tr>\n";
    }
    return "<table>\n" + rows + "</table>\n";
}

/// Draws a chart of the replay that ran on the input itself.
std::string chart_of(const Replayed& replayed)
{
    Chart chart(190.0, replayed.back().end_ms);
    std::vector<std::pair<double, double>> memory;
    uint64_t most = 0;
    for (const ProfiledAction& one : replayed) {
        const std::string name = sentence(one.line, ": ", one.action);
        chart.begin_row(name);
        double from = 0.0;
        const auto stretch = [&](const std::optional<double>& until, const char* color, const char* what) {
            if (!until) return;
            chart.bar(one.begin_ms + from, std::max(*until - from, 0.0), color,
                      sentence(name, what, number_text(Json(*until)), " ms"));
            from = std::max(from, *until);
        };
        stretch(one.paint_ms, PAINT_COLOR, ", painted after ");
        stretch(one.sketch_ms, SKETCH_COLOR, ", sketch after ");
        stretch(one.sharp_ms, SHARP_COLOR, ", sharp after ");
        stretch(one.end_ms - one.begin_ms, REST_COLOR, ", nothing left to do after ");
        memory.emplace_back(one.end_ms, double(one.device_bytes));
        most = std::max(most, one.device_bytes);
    }
    chart.line("device memory", memory, bytes_text(most));
    return chart.svg();
}

std::string legend_of()
{
    std::string legend;
    for (const auto& [color, words] :
         {std::pair(PAINT_COLOR, "until its voxels are painted"), std::pair(SKETCH_COLOR, "until a sketch shows it"),
          std::pair(SHARP_COLOR, "until the picture is sharp"), std::pair(REST_COLOR, "until nothing is left to do")})
        legend += sentence("<span class=\"swatch\" style=\"background:", color, "\"></span>", words, " &nbsp; ");
    return "<p>" + legend + "</p>\n";
}

}  // namespace

std::string page_of(const SessionProfile& profile)
{
    const Json summary = summary_of(profile);
    const size_t replays = profile.replays.size();
    return report::page(
        "SHVR profile of a session", CHART_STYLE,
        sentence("<h1>A session of work</h1>\n<p>", report::escaped(profile.input), ", ",
                 report::escaped(profile.script), ", ", profile.size.x, " x ", profile.size.y, " pixels, ",
                 report::escaped(profile.driver), "</p>\n", legend_of(), chart_of(profile.replays.back()),
                 replays == 1 ? std::string("<p>Done once, so that there is no noise to tell (--replays).</p>\n")
                              : sentence("<p>Done ", replays,
                                         " times; the chart shows the last one. Times in the tables are medians, with "
                                         "minimum and 95th percentile.</p>\n"),
                 whole_table(summary), "<h2>Action by action</h2>\n", actions_table(summary)));
}

}  // namespace shvr::cli
