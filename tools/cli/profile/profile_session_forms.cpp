// Formats the profile of a session of work as JSON, text, table and trace.

#include <algorithm>
#include <sstream>

#include "tools/cli/profile/profile_session.h"

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

Json spread_json(const std::vector<double>& values)
{
    const std::optional<Spread> spread = spread_of(values);
    if (!spread) return nullptr;
    return {{"min", spread->minimum}, {"median", spread->median}, {"p95", spread->p95}, {"max", spread->maximum}};
}

Json spread_json(const Json& actions, const char* key)
{
    std::vector<double> values;
    for (const Json& one : actions)
        if (one[key].is_number()) values.push_back(one[key].get<double>());
    return spread_json(values);
}

constexpr std::pair<const char*, std::optional<double> ProfiledAction::*> TIMES_OF_ACTION[] = {
    {"paint_ms", &ProfiledAction::paint_ms},
    {"sketch_ms", &ProfiledAction::sketch_ms},
    {"sharp_ms", &ProfiledAction::sharp_ms}};

/// Summarises an action over all replays, using only the kinds of times that every replay has.
Json over_replays(const SessionProfile& profile, size_t index)
{
    Json spreads = Json::object();
    for (const auto& [key, time] : TIMES_OF_ACTION) {
        std::vector<double> values;
        for (const Replayed& replayed : profile.replays)
            if (const auto& value = replayed[index].*time) values.push_back(*value);
        spreads[key] = values.size() == profile.replays.size() ? spread_json(values) : Json(nullptr);
    }
    return spreads;
}

/// Summarises the whole script over all replays: sums of its actions' times, and its duration.
Json whole_of(const SessionProfile& profile)
{
    Json whole = Json::object();
    for (const auto& [key, time] : TIMES_OF_ACTION) {
        std::vector<double> sums;
        for (const Replayed& replayed : profile.replays) {
            double sum = 0.0;
            for (const ProfiledAction& one : replayed) sum += (one.*time).value_or(0.0);
            sums.push_back(sum);
        }
        whole[key] = spread_json(sums);
    }
    std::vector<double> lengths;
    for (const Replayed& replayed : profile.replays) lengths.push_back(replayed.back().end_ms);
    whole["session_ms"] = spread_json(lengths);
    return whole;
}

}  // namespace

Json summary_of(const SessionProfile& profile)
{
    // Counts and time stamps come from the last replay, which ran on the input itself; durations are medians over all.
    const Replayed& own = profile.replays.back();
    Json actions = Json::array();
    for (size_t i = 0; i < own.size(); ++i) {
        Json one = action_json(own[i]);
        one["over_replays"] = over_replays(profile, i);
        for (const auto& [key, time] : TIMES_OF_ACTION)
            if (const Json& spread = one["over_replays"][key]; !spread.is_null()) one[key] = spread["median"];
        actions.push_back(std::move(one));
    }
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
            {"replays", profile.replays.size()},
            {"actions", actions},
            {"paint_ms", spread_json(actions, "paint_ms")},
            {"sketch_ms", spread_json(actions, "sketch_ms")},
            {"sharp_ms", spread_json(actions, "sharp_ms")},
            {"whole", whole_of(profile)},
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
    const size_t replays = summary["replays"];
    std::vector<std::vector<std::string>> whole{
        {sentence("the whole script, ", replays, replays == 1 ? " time" : " times"), "min ms", "median ms", "p95 ms",
         "max ms"}};
    for (const auto& [key, words] : WHOLE_SCRIPT) {
        whole.push_back({words});
        for (const char* value : {"min", "median", "p95", "max"})
            whole.back().push_back(number_text(summary["whole"][key][value]));
    }
    std::vector<std::vector<std::string>> totals{{"in all", ""}};
    for (const auto& [name, value] : summary["totals"].items()) totals.push_back({name, value.dump()});
    return table_text(rows) + "\n" + table_text(times) + "\n" + table_text(whole) + "\n" + table_text(totals);
}

std::string trace_of(const SessionProfile& profile)
{
    Json events =
        Json::array({{{"ph", "M"}, {"name", "process_name"}, {"pid", 1}, {"tid", 1}, {"args", {{"name", "session"}}}}});
    Json timed = Json::array();
    for (size_t number = 1; number <= profile.replays.size(); ++number) {
        events.push_back({{"ph", "M"},
                          {"name", "thread_name"},
                          {"pid", 1},
                          {"tid", number},
                          {"args", {{"name", sentence("actions, replay ", number)}}}});
        for (const ProfiledAction& one : profile.replays[number - 1]) {
            timed.push_back({{"ph", "X"},
                             {"name", one.action},
                             {"cat", "action"},
                             {"pid", 1},
                             {"tid", number},
                             {"ts", one.begin_ms * 1000.0},
                             {"dur", (one.end_ms - one.begin_ms) * 1000.0},
                             {"args", action_json(one)}});
            if (number == profile.replays.size())
                timed.push_back({{"ph", "C"},
                                 {"name", "device memory"},
                                 {"pid", 1},
                                 {"ts", one.end_ms * 1000.0},
                                 {"args", {{"bytes", one.device_bytes}}}});
        }
    }
    std::stable_sort(timed.begin(), timed.end(),
                     [](const Json& a, const Json& b) { return a["ts"].get<double>() < b["ts"].get<double>(); });
    for (Json& event : timed) events.push_back(std::move(event));
    const Json trace = {{"traceEvents", events},
                        {"displayTimeUnit", "ms"},
                        {"otherData", {{"input", profile.input}, {"device", profile.device}}}};
    return trace.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string csv_of(const SessionProfile& profile)
{
    std::string text = "replay,begin_ms,end_ms";
    for (const char* column : SESSION_COLUMNS) text += sentence(",", column);
    text += "\n";
    for (size_t number = 1; number <= profile.replays.size(); ++number)
        for (const ProfiledAction& one : profile.replays[number - 1]) {
            const Json row = action_json(one);
            text += sentence(number, ",", row["begin_ms"].dump(), ",", row["end_ms"].dump());
            for (const char* column : SESSION_COLUMNS)
                text += "," + (row[column].is_string() ? row[column].get<std::string>()
                               : row[column].is_null() ? std::string()
                                                       : row[column].dump());
            text += "\n";
        }
    return text;
}

}  // namespace shvr::cli
