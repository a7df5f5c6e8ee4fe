// Compares two profiles of a session of work, action by action and in total.

#include "tools/cli/profile/profile_diff.h"

namespace shvr::cli {

namespace {

constexpr std::pair<const char*, const char*> COMPARED_TIMES[] = {
    {"paint_ms", "to paint"}, {"sketch_ms", "to sketch"}, {"sharp_ms", "to sharp"}, {"session_ms", "begin to end"}};
constexpr size_t OF_ACTIONS = 3;  // the first of these

const Json& member(const Json& object, const char* key, const std::string& file)
{
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (found == object.end())
        fail(file, ": '", key, "' is missing; expected what shvr profile --script --json prints");
    return *found;
}

/// Returns the timing of {min, median, p95}, measured in `replays` replays; null if the profile has null there.
std::optional<Timing> timing_in(const Json& spreads, const char* key, size_t replays, const std::string& file)
{
    const Json& spread = member(spreads, key, file);
    if (spread.is_null()) return std::nullopt;
    const Json times{{"min_ms", number_at(spread, "min", file)},
                     {"median_ms", number_at(spread, "median", file)},
                     {"p95_ms", number_at(spread, "p95", file)}};
    return timing_of(times, "", replays, file);
}

/// Compares two times. If only one of them exists (for example, only one action painted), reports this as the change.
Json compared(const char* words, const std::optional<Timing>& a, const std::optional<Timing>& b)
{
    Json row = compared_times(words, a, b);
    if (a.has_value() != b.has_value()) row["verdict"] = a ? "gone" : "new";
    return row;
}

size_t replays_of(const Json& summary, const std::string& file)
{
    return size_t(number_at(summary, "replays", file));
}

const Json& actions_of(const Json& summary, const std::string& file)
{
    const Json& actions = member(summary, "actions", file);
    if (!actions.is_array()) fail(file, ": 'actions' is no list; expected what shvr profile --script --json prints");
    for (const Json& one : actions)
        if (!member(one, "action", file).is_string() || !member(one, "line", file).is_number_integer())
            fail(file, ": an action has no name or no line; expected what shvr profile --script --json prints");
    return actions;
}

}  // namespace

bool is_of_session(const Json& summary)
{
    return summary.is_object() && summary.contains("actions");
}

Json session_difference_of(const Json& a, const std::string& a_name, const Json& b, const std::string& b_name)
{
    const Json &a_actions = actions_of(a, a_name), &b_actions = actions_of(b, b_name);
    if (a_actions.size() != b_actions.size())
        fail(b_name, ": has ", b_actions.size(), " actions, ", a_name, " has ", a_actions.size(),
             "; expected profiles of one script");
    const size_t a_replays = replays_of(a, a_name), b_replays = replays_of(b, b_name);
    Json actions = Json::array();
    for (size_t i = 0; i < a_actions.size(); ++i) {
        const Json &one = a_actions[i], &other = b_actions[i];
        if (one["action"] != other["action"])
            fail(b_name, ": action ", i + 1, " is ", other["action"], ", in ", a_name, " it is ", one["action"],
                 "; expected profiles of one script");
        Json row{{"line", one["line"]}, {"action", one["action"]}};
        for (const auto& [key, words] : std::span(COMPARED_TIMES).first(OF_ACTIONS))
            row[key] = compared(words, timing_in(member(one, "over_replays", a_name), key, a_replays, a_name),
                                timing_in(member(other, "over_replays", b_name), key, b_replays, b_name));
        actions.push_back(std::move(row));
    }
    Json session = Json::array();
    for (const auto& [key, words] : COMPARED_TIMES)
        session.push_back(compared_times(words, timing_in(member(a, "whole", a_name), key, a_replays, a_name),
                                         timing_in(member(b, "whole", b_name), key, b_replays, b_name)));
    return {{"a", a_name},
            {"b", b_name},
            {"replays", {a_replays, b_replays}},
            {"actions", actions},
            {"session", session},
            {"counters", compared_counts(a.value("totals", Json::object()), b.value("totals", Json::object()))},
            {"memory", compared_memory(a, b)}};
}

std::string session_difference_text(const Json& difference)
{
    std::vector<std::vector<std::string>> times{{"action", "A ms", "B ms", "delta ms", "ratio", "noise ms", "verdict"}};
    Json rows = Json::array();
    for (const Json& one : difference["actions"])
        for (const auto& [key, words] : std::span(COMPARED_TIMES).first(OF_ACTIONS)) {
            Json row = one[key];
            if (row["a_ms"].is_null() && row["b_ms"].is_null()) continue;
            row["name"] = sentence(one["line"].dump(), ": ", one["action"].get<std::string>(), " ", words);
            times.push_back(time_row(row));
            rows.push_back(std::move(row));
        }
    std::vector<std::vector<std::string>> whole{
        {"all actions", "A ms", "B ms", "delta ms", "ratio", "noise ms", "verdict"}};
    for (const Json& row : difference["session"]) whole.push_back(time_row(row));
    std::vector<std::vector<std::string>> work{{"work of a replay", "A", "B", "delta"}},
        bytes{{"bytes", "A", "B", "delta"}};
    for (const Json& row : difference["counters"]) work.push_back(count_row(row));
    for (const Json& row : difference["memory"]) bytes.push_back(count_row(row));
    return sentence("replays: A ", difference["replays"][0], ", B ", difference["replays"][1], "\n\n",
                    table_text(times), "\n", table_text(whole), "\n", table_text(work), "\n", table_text(bytes),
                    note_on_unknown({&rows, &difference["session"]}));
}

}  // namespace shvr::cli
