// The page of a profile: its frames and passes along one axis of time, memory below it, and the table.

#include <algorithm>

#include "tools/cli/profile/profile_report.h"
#include "tools/report/html.h"

namespace shvr::cli {

namespace {

constexpr double CHART_WIDTH = 1400.0, LANE = 22.0, MEMORY_HEIGHT = 80.0, LEFT = 70.0;
constexpr const char* PASS_COLORS[] = {"#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#8a7d18"};
constexpr const char* PAGE_STYLE = R"(body{font:14px/1.4 sans-serif;margin:1em auto;max-width:1500px;color:#222}
table{border-collapse:collapse}td,th{padding:.15em .8em;text-align:right;border-bottom:1px solid #ddd}
td:first-child,th:first-child{text-align:left}svg{background:#fff;border:1px solid #ccc}rect:hover{stroke:#000})";

/// The same colour for a pass wherever it is.
std::string color_of_pass(const std::string& name)
{
    uint32_t hash = 2166136261u;
    for (const char character : name) hash = (hash ^ uint8_t(character)) * 16777619u;
    return PASS_COLORS[hash % std::size(PASS_COLORS)];
}

std::string bar_of(double x, double width, double y, const std::string& color, const std::string& text)
{
    return sentence("<rect x=\"", x, "\" y=\"", y, "\" width=\"", std::max(width, 0.5), "\" height=\"", LANE - 4.0,
                    "\" fill=\"", color, "\"><title>", report::escaped(text), "</title></rect>\n");
}

/// Passes end with their frame, as in the trace: host and device have no clock in common.
std::string bars_of(const Profile& profile, double per_ms)
{
    std::string bars;
    size_t number = 0;
    for (const ProfiledFrame& frame : profile.frames) {
        bars += bar_of(LEFT + frame.begin_ms * per_ms, (frame.end_ms - frame.begin_ms) * per_ms, 20.0, "#999",
                       sentence("frame ", number, ": ", frame.end_ms - frame.begin_ms, " ms"));
        double end = 0.0;
        for (const gpu::PassReport& pass : frame.passes) end = std::max(end, pass.start_ms + pass.gpu_ms);
        for (const gpu::PassReport& pass : frame.passes)
            if (pass.timed)
                bars += bar_of(LEFT + (frame.end_ms - end + pass.start_ms) * per_ms, pass.gpu_ms * per_ms, 20.0 + LANE,
                               color_of_pass(pass.name),
                               sentence(pass.name, ", frame ", number, ": ", pass.gpu_ms, " ms, ", pass.dispatches,
                                        " dispatches", pass.barrier.empty() ? "" : ", after a barrier ", pass.barrier));
        ++number;
    }
    return bars;
}

std::string memory_of(const Profile& profile, double per_ms)
{
    uint64_t most = 1;
    for (const ProfiledFrame& frame : profile.frames) most = std::max(most, frame.device_bytes);
    const double bottom = 30.0 + 2.0 * LANE + MEMORY_HEIGHT;
    std::string line;
    for (const ProfiledFrame& frame : profile.frames)
        line += sentence(LEFT + frame.end_ms * per_ms, ",",
                         bottom - MEMORY_HEIGHT * double(frame.device_bytes) / double(most), " ");
    return sentence("<polyline fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2\" points=\"", line,
                    "\"><title>device memory</title></polyline>\n<text x=\"4\" y=\"", bottom - MEMORY_HEIGHT + 10.0,
                    "\">", most >> 20, " MiB</text>\n<text x=\"4\" y=\"", bottom, "\">0</text>\n");
}

std::string chart_of(const Profile& profile)
{
    double end = 1e-3;
    for (const ProfiledFrame& frame : profile.frames) end = std::max(end, frame.end_ms);
    const double per_ms = (CHART_WIDTH - LEFT - 10.0) / end;
    return sentence("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", CHART_WIDTH, "\" height=\"",
                    40.0 + 2.0 * LANE + MEMORY_HEIGHT,
                    "\" font-size=\"12\" font-family=\"sans-serif\">\n<text x=\"4\" y=\"34\">host</text>\n"
                    "<text x=\"4\" y=\"56\">device</text>\n<text x=\"",
                    CHART_WIDTH - 110.0, "\" y=\"14\">", end, " ms</text>\n", bars_of(profile, per_ms),
                    memory_of(profile, per_ms), "</svg>\n");
}

std::string cell_of(const Json& value)
{
    return value.is_string()         ? report::escaped(value.get<std::string>())
           : value.is_number_float() ? number_text(value)
           : value.is_null()         ? "-"
                                     : value.dump();
}

std::string passes_table(const Json& summary)
{
    constexpr const char* COLUMNS[] = {"name",   "count", "min_ms",   "median_ms",  "p95_ms",
                                       "max_ms", "bytes", "gb_per_s", "dispatches", "barrier"};
    std::string rows = "<tr>";
    for (const char* column : COLUMNS) rows += sentence("<th>", column, "</th>");
    rows += "</tr>\n";
    for (const Json& pass : summary["passes"]) {
        rows += "<tr>";
        for (const char* column : COLUMNS) rows += "<td>" + cell_of(pass[column]) + "</td>";
        rows += "</tr>\n";
    }
    return "<table>\n" + rows + "</table>\n";
}

std::string pairs_table(const Json& object)
{
    std::string rows;
    for (const auto& [name, value] : object.items())
        rows += "<tr><td>" + report::escaped(name) + "</td><td>" + cell_of(value) + "</td></tr>\n";
    return "<table>\n" + rows + "</table>\n";
}

/// A bar for each resource, from its first step to its last, and the budgets and sums in words.
std::string lifetimes_of(const Json& memory)
{
    constexpr double NAMES = 300.0;
    const Json& resources = memory["resources"];
    const double per_step = (CHART_WIDTH - NAMES) / std::max(1.0, memory["steps"].get<double>());
    std::string rows;
    double y = 4.0;
    for (const Json& one : resources) {
        const bool lasting = one["lasting"].get<bool>();
        const double first = lasting ? 0.0 : one["first_step"].get<double>();
        const double end = lasting ? memory["steps"].get<double>() : one["last_step"].get<double>() + 1.0;
        const std::string name = one["name"].get<std::string>();
        rows += sentence(
            "<text x=\"4\" y=\"", y + 14.0, "\">", report::escaped(name), ", ", one["bytes"].dump(), " bytes</text>\n",
            bar_of(NAMES + first * per_step, (end - first) * per_step, y, lasting ? "#bbb" : "#0072b2",
                   sentence(name, lasting ? ": outlives the frame, used from " : ": from ",
                            one["first_pass"].get<std::string>(), " to ", one["last_pass"].get<std::string>())));
        y += LANE;
    }
    return sentence(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", CHART_WIDTH, "\" height=\"", y,
        "\" font-size=\"12\" font-family=\"sans-serif\">\n", rows,
        "</svg>\n<p>Blue: what this frame alone needs, from its first pass to its last. Grey: what outlives "
        "it.</p>\n");
}

/// The numbers of a memory section.
Json totals_of(const Json& summary)
{
    Json totals = summary["memory"];
    totals.erase("resources");
    for (const char* key : {"device", "peak_device", "host", "peak_host"}) totals[key] = summary["bytes"][key];
    return totals;
}

}  // namespace

std::string page_of(const Profile& profile)
{
    const Json summary = summary_of(profile);
    return report::page(
        "SHVR profile", PAGE_STYLE,
        sentence("<h1>Where a frame's time goes</h1>\n<p>", report::escaped(profile.input), ", ", profile.size.x, " x ",
                 profile.size.y, " pixels, ", profile.frames.size(), " frames after ", profile.warmup, " to warm up; ",
                 report::escaped(profile.driver), "</p>\n", chart_of(profile),
                 "<p>Grey: a frame on the host. Colours: passes on the device. Line: device memory.</p>\n",
                 passes_table(summary), "<h2>Work of one frame</h2>\n", pairs_table(summary["counters"]),
                 "<h2>Device memory by resource, bytes</h2>\n", pairs_table(summary["bytes"]["by_resource"]),
                 "<h2>Memory of one frame, step by step</h2>\n", lifetimes_of(summary["memory"]),
                 "<h2>Memory against its budgets, bytes</h2>\n", pairs_table(totals_of(summary))));
}

}  // namespace shvr::cli
