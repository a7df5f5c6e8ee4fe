// The profile of a session of work as text, table, trace and page.

#include <algorithm>
#include <sstream>

#include "tools/cli/profile/profile_session.h"
#include "tools/report/html.h"

namespace shvr::cli {

namespace {

constexpr const char* SESSION_COLUMNS[] = {"line",      "action",         "paint_ms",    "sketch_ms",
                                           "sharp_ms",  "submits",        "uploads",     "allocations",
                                           "evictions", "voxels_painted", "device_bytes"};

Json number_or_null(const std::optional<double>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

Json action_json(const ProfiledAction& one)
{
    return {{"line", one.line},
            {"action", one.action},
            {"begin_ms", one.begin_ms},
            {"end_ms", one.end_ms},
            {"paint_ms", number_or_null(one.paint_ms)},
            {"sketch_ms", number_or_null(one.sketch_ms)},
            {"sharp_ms", number_or_null(one.sharp_ms)},
            {"submits", one.submits},
            {"allocations", one.allocations},
            {"uploads", one.uploads},
            {"evictions", one.evictions},
            {"voxels_painted", one.voxels_painted},
            {"device_bytes", one.device_bytes}};
}

std::string session_cell(const Json& value)
{
    return value.is_string() ? value.get<std::string>() : value.is_number_integer() ? value.dump() : number_text(value);
}

Json spread_json(const Json& actions, const char* key)
{
    std::vector<double> values;
    for (const Json& one : actions)
        if (one[key].is_number()) values.push_back(one[key].get<double>());
    const std::optional<Spread> spread = spread_of(values);
    if (!spread) return nullptr;
    return {{"min", spread->minimum}, {"median", spread->median}, {"p95", spread->p95}, {"max", spread->maximum}};
}

}  // namespace

Json summary_of(const SessionProfile& profile)
{
    Json actions = Json::array();
    for (const ProfiledAction& one : profile.actions) actions.push_back(action_json(one));
    Json totals = Json::object();
    for (const char* key : {"submits", "allocations", "uploads", "evictions", "voxels_painted"}) {
        int64_t sum = 0;
        for (const Json& one : actions) sum += one[key].get<int64_t>();
        totals[key] = sum;
    }
    return {{"input", profile.input},
            {"script", profile.script},
            {"device", profile.device},
            {"driver", profile.driver},
            {"size", {profile.size.x, profile.size.y}},
            {"actions", actions},
            {"paint_ms", spread_json(actions, "paint_ms")},
            {"sketch_ms", spread_json(actions, "sketch_ms")},
            {"sharp_ms", spread_json(actions, "sharp_ms")},
            {"totals", totals},
            {"bytes", profile.bytes},
            {"device_budget", profile.device_budget},
            {"host_budget", profile.host_budget}};
}

std::string session_text(const Json& summary)
{
    std::vector<std::vector<std::string>> rows{{std::begin(SESSION_COLUMNS), std::end(SESSION_COLUMNS)}};
    for (const Json& one : summary["actions"]) {
        rows.emplace_back();
        for (const char* column : SESSION_COLUMNS) rows.back().push_back(session_cell(one[column]));
    }
    std::vector<std::vector<std::string>> times{{"from an action", "min ms", "median ms", "p95 ms", "max ms"}};
    for (const auto& [key, words] :
         {std::pair("paint_ms", "to paint"), std::pair("sketch_ms", "to sketch"), std::pair("sharp_ms", "to sharp")}) {
        times.push_back({words});
        for (const char* value : {"min", "median", "p95", "max"})
            times.back().push_back(summary[key].is_null() ? "-" : number_text(summary[key][value]));
    }
    std::vector<std::vector<std::string>> totals{{"in all", ""}};
    for (const auto& [name, value] : summary["totals"].items()) totals.push_back({name, value.dump()});
    return table_text(rows) + "\n" + table_text(times) + "\n" + table_text(totals);
}

std::string trace_of(const SessionProfile& profile)
{
    Json events =
        Json::array({{{"ph", "M"}, {"name", "process_name"}, {"pid", 1}, {"tid", 1}, {"args", {{"name", "session"}}}},
                     {{"ph", "M"}, {"name", "thread_name"}, {"pid", 1}, {"tid", 1}, {"args", {{"name", "actions"}}}}});
    for (const ProfiledAction& one : profile.actions) {
        events.push_back({{"ph", "X"},
                          {"name", one.action},
                          {"cat", "action"},
                          {"pid", 1},
                          {"tid", 1},
                          {"ts", one.begin_ms * 1000.0},
                          {"dur", (one.end_ms - one.begin_ms) * 1000.0},
                          {"args", action_json(one)}});
        events.push_back({{"ph", "C"},
                          {"name", "device memory"},
                          {"pid", 1},
                          {"ts", one.end_ms * 1000.0},
                          {"args", {{"bytes", one.device_bytes}}}});
    }
    const Json trace = {{"traceEvents", events},
                        {"displayTimeUnit", "ms"},
                        {"otherData", {{"input", profile.input}, {"device", profile.device}}}};
    return trace.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string csv_of(const SessionProfile& profile)
{
    std::string text = "begin_ms,end_ms";
    for (const char* column : SESSION_COLUMNS) text += sentence(",", column);
    text += "\n";
    for (const ProfiledAction& one : profile.actions) {
        const Json row = action_json(one);
        text += row["begin_ms"].dump() + "," + row["end_ms"].dump();
        for (const char* column : SESSION_COLUMNS)
            text += "," + (row[column].is_string() ? row[column].get<std::string>()
                           : row[column].is_null() ? std::string()
                                                   : row[column].dump());
        text += "\n";
    }
    return text;
}

std::string page_of(const SessionProfile& profile)
{
    constexpr double WIDTH = 1400.0, ROW = 22.0, NAMES = 160.0;
    const double end = std::max(1e-3, profile.actions.back().end_ms), per_ms = (WIDTH - NAMES) / end;
    std::string bars, rows = "<tr>";
    double y = 4.0;
    const auto bar = [&](double begin, double length, const char* color, const std::string& title) {
        bars += sentence("<rect x=\"", NAMES + begin * per_ms, "\" y=\"", y, "\" width=\"",
                         std::max(0.5, length * per_ms), "\" height=\"", ROW - 4.0, "\" fill=\"", color, "\"><title>",
                         report::escaped(title), "</title></rect>\n");
    };
    for (const char* column : SESSION_COLUMNS) rows += sentence("<th>", column, "</th>");
    rows += "</tr>\n";
    for (const ProfiledAction& one : profile.actions) {
        const std::string name = sentence(one.line, ": ", one.action);
        bars += sentence("<text x=\"4\" y=\"", y + 14.0, "\">", report::escaped(name), "</text>\n");
        if (one.sharp_ms)
            bar(one.begin_ms, *one.sharp_ms, "#56b4e9", sentence(name, ", sharp after ", *one.sharp_ms, " ms"));
        if (one.sketch_ms)
            bar(one.begin_ms, *one.sketch_ms, "#0072b2", sentence(name, ", sketch after ", *one.sketch_ms, " ms"));
        y += ROW;
        const Json row = action_json(one);
        rows += "<tr>";
        for (const char* column : SESSION_COLUMNS)
            rows += "<td>" + report::escaped(session_cell(row[column])) + "</td>";
        rows += "</tr>\n";
    }
    return report::page(
        "SHVR profile of a session",
        "body{font:14px/1.4 sans-serif;margin:1em auto;max-width:1500px;color:#222}table{border-collapse:collapse}"
        "td,th{padding:.15em .8em;text-align:right;border-bottom:1px solid #ddd}svg{border:1px solid #ccc}",
        sentence("<h1>A session of work</h1>\n<p>", report::escaped(profile.input), ", ",
                 report::escaped(profile.script), ", ", profile.size.x, " x ", profile.size.y, " pixels, ",
                 report::escaped(profile.driver), "</p>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", WIDTH,
                 "\" height=\"", y, "\" font-size=\"12\" font-family=\"sans-serif\">\n", bars,
                 "</svg>\n<p>Dark: until a sketch shows the action. Light: until the picture is sharp. All: ", end,
                 " ms.</p>\n<table>\n", rows, "</table>\n"));
}

}  // namespace shvr::cli
