#include "tools/cli/profile/profile_diff.h"

#include <cmath>
#include <iomanip>
#include <limits>

#include "tools/report/noise.h"

namespace shvr::cli {

namespace {

const Json& passes_of(const Json& summary, const std::string& file)
{
    const auto passes = summary.is_object() ? summary.find("passes") : summary.end();
    if (passes == summary.end() || !passes->is_array())
        fail(file, ": the list 'passes' is missing; expected what shvr profile --json prints");
    for (const Json& pass : *passes)
        if (!pass.is_object() || !pass.contains("name") || !pass["name"].is_string())
            fail(file, ": the 'name' of a pass is missing; expected what shvr profile --json prints");
    return *passes;
}

const Json* find_pass(const Json& passes, const std::string& name)
{
    for (const Json& pass : passes)
        if (pass["name"] == name) return &pass;
    return nullptr;
}

/// Returns the number of measurements. Older profiles do not state it; they have many measurements.
size_t count_of(const Json& object, const char* key)
{
    const auto count = object.find(key);
    return count != object.end() && count->is_number_unsigned() ? count->get<size_t>()
                                                                : std::numeric_limits<size_t>::max();
}

/// Returns a pass's times on the device or, with the prefix "record_", the host's times for recording the pass.
std::optional<Timing> timing_of_pass(const Json* pass, const std::string& prefix, const std::string& file)
{
    return pass ? timing_of(*pass, prefix, count_of(*pass, "count"), file) : std::nullopt;
}

/// Compares all passes: first those of A, in A's order, then those that only B has.
Json passes_compared(const Json& a, const std::string& a_name, const Json& b, const std::string& b_name,
                     const std::string& prefix)
{
    Json rows = Json::array();
    for (const Json& pass : a) {
        const std::string name = pass["name"];
        const Json* const other = find_pass(b, name);
        rows.push_back(
            compared_times(name, timing_of_pass(&pass, prefix, a_name), timing_of_pass(other, prefix, b_name)));
        if (!other) rows.back()["verdict"] = "gone";
    }
    for (const Json& pass : b) {
        const std::string name = pass["name"];
        if (find_pass(a, name)) continue;
        rows.push_back(compared_times(name, std::nullopt, timing_of_pass(&pass, prefix, b_name)));
        rows.back()["verdict"] = "new";
    }
    return rows;
}

std::string signed_text(const Json& value)
{
    const std::string text = number_text(value);
    return value.is_number() && value.get<double>() >= 0.0 ? "+" + text : text;
}

}  // namespace

double number_at(const Json& object, const char* key, const std::string& file)
{
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number())
        fail(file, ": '", key, "' is not a number; expected what shvr profile --json prints");
    return found->get<double>();
}

std::optional<Timing> timing_of(const Json& object, const std::string& prefix, size_t count, const std::string& file)
{
    const auto median = object.find(prefix + "median_ms");
    if (median == object.end() || median->is_null()) return std::nullopt;
    const double minimum = number_at(object, (prefix + "min_ms").c_str(), file);
    const double p95 = number_at(object, (prefix + "p95_ms").c_str(), file);
    return Timing{number_at(object, (prefix + "median_ms").c_str(), file), report::noise_of(minimum, p95, count)};
}

Json compared_times(const std::string& name, const std::optional<Timing>& a, const std::optional<Timing>& b)
{
    Json row{{"name", name},     {"a_ms", nullptr},     {"b_ms", nullptr},  {"delta_ms", nullptr},
             {"ratio", nullptr}, {"noise_ms", nullptr}, {"verdict", "same"}};
    if (a) row["a_ms"] = a->median;
    if (b) row["b_ms"] = b->median;
    if (a.has_value() != b.has_value()) row["verdict"] = "unknown";
    if (!a || !b) return row;
    const double delta = b->median - a->median;
    const std::optional<double> noise = report::noise_of_both(a->noise, b->noise);
    row["delta_ms"] = delta;
    if (a->median > 0.0) row["ratio"] = b->median / a->median;
    if (noise) row["noise_ms"] = *noise;
    row["verdict"] = !noise ? "unknown" : std::abs(delta) <= *noise ? "same" : delta < 0.0 ? "faster" : "slower";
    return row;
}

Json compared_counts(const Json& a, const Json& b)
{
    Json rows = Json::array();
    if (!a.is_object() || !b.is_object()) return rows;
    for (const auto& [name, value] : a.items()) {
        const auto other = b.find(name);
        if (other == b.end() || !value.is_number_integer() || !other->is_number_integer()) continue;
        // Subtracted as unsigned numbers, since the difference of arbitrary numbers may overflow int64_t.
        const auto delta = int64_t(other->get<uint64_t>() - value.get<uint64_t>());
        rows.push_back({{"name", name}, {"a", value}, {"b", *other}, {"delta", delta}});
    }
    return rows;
}

Json compared_memory(const Json& a, const Json& b)
{
    const auto bytes_in = [](const Json& summary) {
        const auto bytes = summary.find("bytes");
        return bytes == summary.end() ? Json::object() : *bytes;
    };
    return compared_counts(bytes_in(a), bytes_in(b));
}

std::vector<std::string> time_row(const Json& row)
{
    const Json& noise = row["noise_ms"];
    return {row["name"],
            number_text(row["a_ms"]),
            number_text(row["b_ms"]),
            signed_text(row["delta_ms"]),
            row["ratio"].is_null() ? "-" : sentence(std::fixed, std::setprecision(2), row["ratio"].get<double>()),
            noise.is_null() ? "-" : "+-" + number_text(noise),
            row["verdict"]};
}

std::vector<std::string> count_row(const Json& row)
{
    return {row["name"], row["a"].dump(), row["b"].dump(), row["delta"].dump()};
}

std::string note_on_unknown(const std::vector<const Json*>& lists)
{
    for (const Json* const list : lists)
        for (const Json& row : *list)
            if (row["verdict"] == "unknown")
                return sentence("\nunknown: what was measured fewer than ", report::MIN_TIMES,
                                " times tells no noise (--frames, or --replays with --script)\n");
    return {};
}

Json difference_of(const Json& a, const std::string& a_name, const Json& b, const std::string& b_name)
{
    if (is_of_session(a) != is_of_session(b))
        fail(is_of_session(a) ? a_name : b_name, ": is the profile of a session (--script), and ",
             is_of_session(a) ? b_name : a_name, " is not; expected two of one kind");
    if (is_of_session(a)) return session_difference_of(a, a_name, b, b_name);
    const Json& a_passes = passes_of(a, a_name);
    const Json& b_passes = passes_of(b, b_name);
    return {{"a", a_name},
            {"b", b_name},
            {"passes", passes_compared(a_passes, a_name, b_passes, b_name, "")},
            {"recording", passes_compared(a_passes, a_name, b_passes, b_name, "record_")},
            {"frame", compared_times("frame", timing_of(a, "frame_", count_of(a, "frames"), a_name),
                                     timing_of(b, "frame_", count_of(b, "frames"), b_name))},
            {"counters", compared_counts(a.value("counters", Json::object()), b.value("counters", Json::object()))},
            {"memory", compared_memory(a, b)}};
}

std::string difference_text(const Json& difference)
{
    const std::string names =
        sentence("A = ", difference["a"].get<std::string>(), "\nB = ", difference["b"].get<std::string>(), "\n\n");
    if (difference.contains("actions")) return names + session_difference_text(difference);
    std::vector<std::vector<std::string>> times{{"pass", "A ms", "B ms", "delta ms", "ratio", "noise ms", "verdict"}};
    for (const Json& row : difference["passes"]) times.push_back(time_row(row));
    times.push_back(time_row(difference["frame"]));
    std::vector<std::vector<std::string>> records{
        {"recorded by the host", "A ms", "B ms", "delta ms", "ratio", "noise ms", "verdict"}};
    for (const Json& row : difference["recording"])
        if (!row["a_ms"].is_null() || !row["b_ms"].is_null()) records.push_back(time_row(row));
    std::vector<std::vector<std::string>> work{{"work", "A", "B", "delta"}}, bytes{{"bytes", "A", "B", "delta"}};
    for (const Json& row : difference["counters"]) work.push_back(count_row(row));
    for (const Json& row : difference["memory"]) bytes.push_back(count_row(row));
    const Json frame = Json::array({difference["frame"]});
    std::string text = names + table_text(times);
    for (const auto& table : {records, work, bytes})
        if (table.size() > 1) text += "\n" + table_text(table);
    return text + note_on_unknown({&difference["passes"], &frame});
}

}  // namespace shvr::cli
