#include <cmath>
#include <iomanip>

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

namespace {

/// One run's measurement of a pass or of the frame.
struct Measured {
    double median = 0.0;
    double noise = 0.0;  ///< half of minimum ... p95
};

double number_at(const Json& object, const char* key, const std::string& file)
{
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number())
        fail(file, ": '", key, "' is not a number; expected what shvr profile --json prints");
    return found->get<double>();
}

/// Nothing if the run had no times.
std::optional<Measured> measured(const Json& object, const std::string& prefix, const std::string& file)
{
    const auto median = object.find(prefix + "median_ms");
    if (median == object.end() || median->is_null()) return std::nullopt;
    const double minimum = number_at(object, (prefix + "min_ms").c_str(), file);
    const double p95 = number_at(object, (prefix + "p95_ms").c_str(), file);
    return Measured{number_at(object, (prefix + "median_ms").c_str(), file), (p95 - minimum) / 2.0};
}

Json compared(const std::string& name, const std::optional<Measured>& a, const std::optional<Measured>& b)
{
    Json row{{"name", name},     {"a_ms", nullptr},     {"b_ms", nullptr},  {"delta_ms", nullptr},
             {"ratio", nullptr}, {"noise_ms", nullptr}, {"verdict", "same"}};
    if (a) row["a_ms"] = a->median;
    if (b) row["b_ms"] = b->median;
    if (!a || !b) return row;
    const double delta = b->median - a->median;
    const double noise = std::hypot(a->noise, b->noise);
    row["delta_ms"] = delta;
    if (a->median > 0.0) row["ratio"] = b->median / a->median;
    row["noise_ms"] = noise;
    row["verdict"] = std::abs(delta) <= noise ? "same" : delta < 0.0 ? "faster" : "slower";
    return row;
}

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

Json counters_compared(const Json& a, const Json& b)
{
    Json rows = Json::array();
    if (!a.contains("counters") || !b.contains("counters")) return rows;
    for (const auto& [name, value] : a["counters"].items()) {
        const auto other = b["counters"].find(name);
        if (other == b["counters"].end() || !value.is_number_integer() || !other->is_number_integer()) continue;
        // Unsigned, because the difference of arbitrary numbers may exceed int64_t.
        const auto delta = int64_t(other->get<uint64_t>() - value.get<uint64_t>());
        rows.push_back({{"name", name}, {"a", value}, {"b", *other}, {"delta", delta}});
    }
    return rows;
}

std::string signed_text(const Json& value)
{
    const std::string text = number_text(value);
    return value.is_number() && value.get<double>() >= 0.0 ? "+" + text : text;
}

std::vector<std::string> row_of(const Json& row)
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

}  // namespace

Json difference_of(const Json& a, const std::string& a_name, const Json& b, const std::string& b_name)
{
    const Json& a_passes = passes_of(a, a_name);
    const Json& b_passes = passes_of(b, b_name);
    Json passes = Json::array();
    for (const Json& pass : a_passes) {
        const std::string name = pass["name"];
        const Json* other = find_pass(b_passes, name);
        passes.push_back(
            compared(name, measured(pass, "", a_name), other ? measured(*other, "", b_name) : std::nullopt));
        if (!other) passes.back()["verdict"] = "gone";
    }
    for (const Json& pass : b_passes) {
        const std::string name = pass["name"];
        if (find_pass(a_passes, name)) continue;
        passes.push_back(compared(name, std::nullopt, measured(pass, "", b_name)));
        passes.back()["verdict"] = "new";
    }
    return {{"a", a_name},
            {"b", b_name},
            {"passes", passes},
            {"frame", compared("frame", measured(a, "frame_", a_name), measured(b, "frame_", b_name))},
            {"counters", counters_compared(a, b)}};
}

std::string difference_text(const Json& difference)
{
    std::vector<std::vector<std::string>> times{{"pass", "A ms", "B ms", "delta ms", "ratio", "noise ms", "verdict"}};
    for (const Json& row : difference["passes"]) times.push_back(row_of(row));
    times.push_back(row_of(difference["frame"]));
    std::vector<std::vector<std::string>> work{{"work", "A", "B", "delta"}};
    for (const Json& row : difference["counters"])
        work.push_back({row["name"], row["a"].dump(), row["b"].dump(), row["delta"].dump()});
    return sentence("A = ", difference["a"].get<std::string>(), "\nB = ", difference["b"].get<std::string>(), "\n\n",
                    table_text(times), work.size() > 1 ? "\n" + table_text(work) : "");
}

}  // namespace shvr::cli
