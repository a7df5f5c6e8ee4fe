#pragma once
// A study's report, made only from its rows: one HTML page without external files, readable in light and dark themes.
// Equal rows give equal bytes on every machine. Any thread.

#include <string>
#include <vector>

#include "engine/study/repeats.h"
#include "engine/study/report/baselines.h"
#include "engine/study/rows.h"

namespace shvr {

/// One parameter of the modelled hand, with its source.
struct HandParameter {
    std::string name, value, unit, source;
};

/// The central comparison, repeated with one parameter of the hand multiplied by `factor`.
struct HandVariation {
    std::string parameter;
    double factor = 1.0;
    std::vector<StudyRow> rows;  ///< at least the rows of the central condition and of `none`
};

struct StudyReport {
    std::string command;     ///< command line that reproduces this report
    std::string version;     ///< version of this program
    std::string phantom;     ///< the annotated volume, in a sentence
    std::string annotators;  ///< how they are modelled, in sentences
    StudyCondition centre;   ///< central condition, from which one factor at a time is varied; its task is ignored
    std::vector<StudyRow> rows;
    std::vector<HandParameter> hand;
    std::vector<HandVariation> variations;
    std::vector<StudyRepeat> repeats;
    std::vector<BaselineRow> baselines;
    std::string no_baselines;  ///< why there are none, if so
};

std::string page_of(const StudyReport& report);

/// Returns the condition without touch to compare a condition with: same task, noise and probe, and the same law if
/// such a condition exists. Returns null if the rows have no such condition.
const StudyCondition* base_of(const StudyCondition& condition, const std::vector<StudyCondition>& conditions);

/// Describes a condition, as in "object, default law, ball of 1.5 radii, noise 10 %".
std::string words_of(const StudyCondition& condition);

/// Returns the study's result for one task as a sentence with a number, its interval and the number of pairs; empty if
/// a condition to be compared has no rows.
std::string claim_of(const StudyReport& report, StudyTask task);

}  // namespace shvr
