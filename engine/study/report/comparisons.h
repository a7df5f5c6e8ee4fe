#pragma once
// A study's comparisons of touch with no touch, as markup: main outcomes, outcomes that touch makes worse, and whether
// the verdicts depend on the modelled hand. Any thread.

#include <string>

#include "engine/study/report/report.h"

namespace shvr {

/// Tasks in the order in which the report shows them.
inline constexpr StudyTask REPORTED_TASKS[] = {StudyTask::paint, StudyTask::trace};

/// Tabulates the main outcome of a task: a row for each condition with touch, compared in pairs with no touch.
std::string main_table_of(const StudyReport& report, StudyTask task);
/// Lists where touch does not help: pairs in which the central condition is worse, conditions whose main outcome does
/// not improve, and the best condition without touch, which may be as good as the central condition.
std::string limits_of(const StudyReport& report);
/// Tabulates all outcomes whose difference from no touch has its whole interval on the worse side.
std::string worse_table_of(const StudyReport& report);
/// Tabulates whether the central comparison has the same verdict with each hand parameter halved and doubled. These
/// runs have fewer pairs, so a row also gives the verdict of the unchanged hand in the same pairs.
std::string robustness_table_of(const StudyReport& report);

}  // namespace shvr
