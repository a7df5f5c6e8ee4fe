#include "engine/annotation/patterns/pattern_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/annotation/measures/measures.h"
#include "engine/annotation/patterns/pattern_codebook.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

const PatternMeasure* measure_named(std::string_view name)
{
    const auto found = std::ranges::find(PATTERN_MEASURES, name, [](const PatternMeasure& each) { return each.name; });
    SHVR_CHECK(found != std::end(PATTERN_MEASURES), std::string(name));
    return found;
}

/// Formats a value with 9 significant digits; ratios and angles below 1e-9 become 0. This hides rounding errors of the
/// standard library's functions, which differ between machines.
std::string nine_digits(double value, const PatternMeasure& measure)
{
    const bool has_length = std::string_view(measure.unit).find("LENGTH") != std::string_view::npos;
    if (std::abs(value) < (has_length ? 1e-300 : 1e-9)) value = 0.0;
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 9);
    return std::string(text, end.ptr);
}

std::string unit_of(const PatternMeasure& measure, const std::string& unit)
{
    std::string text = measure.unit;
    if (const size_t at = text.find("LENGTH"); at != std::string::npos) text.replace(at, 6, unit);
    return csv_field(text);
}

}  // namespace

std::span<const PatternMeasure> pattern_measures()
{
    return PATTERN_MEASURES;
}

void PatternRows::add(const char* measure, const std::string& name, double value)
{
    SHVR_CHECK(std::isfinite(value), name);
    rows_.push_back({measure_named(measure), name, value});
}

void PatternRows::miss(const char* measure, const std::string& name, const std::string& reason)
{
    rows_.push_back({measure_named(measure), name, {}, reason});
}

void PatternRows::withdraw(const std::string& reason)
{
    for (PatternRow& row : rows_)
        if (row.measure->needs_axis && row.value) row = {row.measure, row.name, {}, reason};
}

const PatternRow* PatternRows::find(std::string_view name) const
{
    const auto found = std::ranges::find(rows_, name, &PatternRow::name);
    return found == rows_.end() ? nullptr : &*found;
}

std::optional<double> PatternRows::value(std::string_view name) const
{
    const PatternRow* row = find(name);
    return row ? row->value : std::nullopt;
}

std::string PatternRows::reason(std::string_view name) const
{
    const PatternRow* row = find(name);
    return row ? row->reason : "";
}

std::string pattern_csv(const PatternRows& rows, const std::string& unit)
{
    std::string text;
    for (const PatternRow& row : rows.rows()) {
        text += "pattern,,," + row.name + "," + (row.value ? nine_digits(*row.value, *row.measure) : "") + "," +
                unit_of(*row.measure, unit) + "\r\n";
        if (!row.value) text += "reason,,," + csv_field(row.name + ": " + row.reason) + ",,text\r\n";
    }
    return text;
}

std::string pattern_codebook()
{
    std::string text =
        "| measure | unit | needs the axis | definition | source, closed form |\n|---|---|---|---|---|\n";
    for (const PatternMeasure& measure : PATTERN_MEASURES)
        text += sentence("| ", measure.name, " | ", measure.unit, " | ", measure.needs_axis ? "yes" : "no", " | ",
                         measure.definition, " | ", measure.source, " |\n");
    return text;
}

}  // namespace shvr
