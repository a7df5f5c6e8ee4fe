#pragma once
// A study's comparisons with no touch, as markup: main outcomes, results that touch makes worse, whether the answer
// depends on the modelled hand. Any thread.

#include <string>

#include "engine/study/report/report.h"

namespace shvr {

/// The tasks in the order of the report.
inline constexpr StudyTask REPORTED_TASKS[] = {StudyTask::paint, StudyTask::trace};

/// The main outcome of a task: a line for each condition with touch, compared with no touch in the same pairs.
std::string main_table_of(const StudyReport& report, StudyTask task);
/// Where touch does not help: pairs that are worse at the centre, conditions without a better main outcome, and the
/// best condition without touch, which may be as good as the centre.
std::string limits_of(const StudyReport& report);
/// Differences from no touch whose interval lies on the worse side, in any outcome.
std::string worse_table_of(const StudyReport& report);
/// Whether the central comparison has the same answer with each parameter of the hand halved and doubled. Those have
/// fewer pairs than the centre, so a line shows the stated hand in the same pairs, too.
std::string robustness_table_of(const StudyReport& report);

}  // namespace shvr
