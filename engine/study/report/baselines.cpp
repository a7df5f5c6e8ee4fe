#include "engine/study/report/baselines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

constexpr int64_t MAX_BASELINE_BYTES = int64_t(1) << 24;
constexpr const char* REMEDY = "; make the file again with tools/study/baselines.py";

/// Splits a line of CSV (RFC 4180), whose fields have no line breaks. In quotes, fields may contain commas and "".
std::vector<std::string> fields_of(std::string_view line)
{
    std::vector<std::string> fields(1);
    bool is_quoted = false;
    for (size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"')
            fields.back() += line[i++];
        else if (line[i] == '"')
            is_quoted = !is_quoted;
        else if (line[i] == ',' && !is_quoted)
            fields.emplace_back();
        else
            fields.back() += line[i];
    }
    return fields;
}

void take(const std::string& name, const std::string& field, const std::string& place, BaselineRow& row)
{
    if (name == "method") row.method = field;
    if (name == "skipped") row.skipped = field;
    if (name == "method" || name == "skipped" || field.empty()) return;
    const std::optional<double> number = number_of(field);
    const bool is_count = name == "seed";
    const double most = is_count ? double(std::numeric_limits<uint32_t>::max()) : std::numeric_limits<double>::max();
    if (!number || !std::isfinite(*number) || std::abs(*number) > most ||
        (is_count && (*number < 0.0 || *number != std::floor(*number))))
        fail(place, ", column ", in_quotes(name), ": ", in_quotes(field), " is not ",
             is_count ? "a whole number from 0 to 4294967295" : "a finite number", REMEDY);
    if (is_count) row.seed = uint32_t(*number);
    if (name == "noise") row.noise = *number;
    for (const OutcomeColumn& column : outcome_columns())
        if (column.name == name) row.values[size_t(column.outcome)] = *number;
}

}  // namespace

std::vector<BaselineRow> read_baselines(const std::filesystem::path& file)
{
    const std::string text = read_text(file, MAX_BASELINE_BYTES);
    std::string_view rest = text;
    const std::vector<std::string> names = fields_of(take_line(rest));
    for (const char* const needed : {"method", "noise", "seed", "skipped"})
        if (std::ranges::find(names, needed) == names.end())
            fail(file.string(), ": line 1 has no column ", needed,
                 "; expected method, noise, seed, skipped and names of outcomes", REMEDY);
    std::vector<BaselineRow> rows;
    for (size_t number = 2; !rest.empty(); ++number) {
        const std::string place = sentence(file.string(), ": line ", number);
        const std::vector<std::string> fields = fields_of(take_line(rest));
        if (fields.size() != names.size()) fail(place, " has ", fields.size(), " fields, not ", names.size(), REMEDY);
        BaselineRow row{};
        row.values.fill(std::numeric_limits<double>::quiet_NaN());
        for (size_t i = 0; i < fields.size(); ++i) take(names[i], fields[i], place, row);
        if (row.method.empty()) fail(place, ", column method: is empty, not a method's name", REMEDY);
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace shvr
