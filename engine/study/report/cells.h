#pragma once
// Table cells and headings of a report, and readable names of outcomes. Any thread.

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "engine/study/report/report.h"
#include "engine/study/statistics.h"

namespace shvr {

inline constexpr const char* END = "</tbody></table>\n";

std::string cell(std::string_view words, const char* look = "");
std::string head(std::initializer_list<std::string_view> names);
/// Formats as "0.945 [0.935, 0.955]"; a single value as the mean alone, no value as "-".
std::string with_interval(const Summary& summary);

const OutcomeColumn& column_of(Outcome outcome);
/// Returns the name of a column, with its unit if it has one.
std::string heading_of(Outcome outcome);
/// Describes the main outcome of a task in words, with its column and unit.
std::string main_outcome_in_words(StudyTask task);
/// "Painting"
std::string name_of(StudyTask task);
/// Returns the outcomes for which rows of a task have values.
std::vector<Outcome> outcomes_of(const StudyReport& report, StudyTask task);
StudyCondition centre_of(const StudyReport& report, StudyTask task);

}  // namespace shvr
