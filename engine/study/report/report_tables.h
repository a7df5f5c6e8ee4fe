#pragma once
// Tables of a study's report, as markup. Any thread.

#include <string>

#include "engine/study/report/report.h"

namespace shvr {

/// Shows table 6.1 of the thesis, with the same columns for the simulated annotators under the central condition.
std::string thesis_table_of(const StudyReport& report);
/// Tabulates means with intervals: a row for each condition, a column for each outcome of the task.
std::string means_table_of(const StudyReport& report, StudyTask task);
std::string repeat_table_of(const StudyReport& report);
std::string baseline_table_of(const StudyReport& report);
std::string hand_table_of(const StudyReport& report);
/// Lists the columns of a row: name, unit, meaning, and whether higher or lower is better.
std::string codebook();
/// Lists the seeds of each condition, and all rows as CSV.
std::string data_of(const StudyReport& report);

}  // namespace shvr
