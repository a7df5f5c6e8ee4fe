#pragma once
// The measures of a flower head's pattern: their names, units and definitions, and the values found. Any thread.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shvr {

/// A row of the codebook. `LENGTH` in a unit stands for the volume's unit.
struct PatternMeasure {
    const char* name;  ///< in capitals: parts that vary
    const char* unit;
    const char* definition;
    const char* source;  ///< equation, closed form, or publication
    bool needs_axis = true;
};
std::span<const PatternMeasure> pattern_measures();

struct PatternRow {
    const PatternMeasure* measure;
    std::string name;  ///< with its varying parts filled in
    std::optional<double> value;
    std::string reason{};  ///< a clause that says why there is no value
};

/// Rows of a table in the order in which they were added. Measures must be in `pattern_measures` (SHVR_CHECK).
class PatternRows {
public:
    void add(const char* measure, double value) { add(measure, measure, value); }
    /// `name` is the name of the measure with its varying parts filled in. A value that is not finite is a bug.
    void add(const char* measure, const std::string& name, double value);
    void miss(const char* measure, const std::string& reason) { miss(measure, measure, reason); }
    void miss(const char* measure, const std::string& name, const std::string& reason);

    /// Replaces the values of all measures that need the axis by a reason.
    void withdraw(const std::string& reason);

    const std::vector<PatternRow>& rows() const { return rows_; }
    /// Null if there is no such row, or if it has no value.
    std::optional<double> value(std::string_view name) const;
    /// Empty if there is no such row, or if it has a value.
    std::string reason(std::string_view name) const;

private:
    const PatternRow* find(std::string_view name) const;
    std::vector<PatternRow> rows_;
};

/// Rows of the table of measures (measures.h): item "pattern" with measure, value and unit. If a value is missing, a
/// row with item "reason" and the text "MEASURE: REASON" follows. Values have 9 significant digits.
std::string pattern_csv(const PatternRows& rows, const std::string& unit);

/// The codebook's table, in Markdown.
std::string pattern_codebook();

}  // namespace shvr
