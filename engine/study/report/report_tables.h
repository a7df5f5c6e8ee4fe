#pragma once
// Tables of a study's report, as markup. Any thread.

#include <string>

#include "engine/study/report/report.h"

namespace shvr {

/// The thesis's table 6.1, and the same columns of the simulated annotators at the centre.
std::string thesis_table_of(const StudyReport& report);
/// Means with intervals: a line for each condition, a column for each outcome that the task has.
std::string means_table_of(const StudyReport& report, StudyTask task);
std::string repeat_table_of(const StudyReport& report);
std::string baseline_table_of(const StudyReport& report);
std::string hand_table_of(const StudyReport& report);
/// Every column of a row: name, unit, meaning, which side is better.
std::string codebook();
/// The seeds of each condition, and all rows as CSV.
std::string data_of(const StudyReport& report);

}  // namespace shvr
