#pragma once
// A study's report: one HTML page without external files, readable in light and dark, from rows alone. The same rows
// give the same bytes on every machine. Any thread.

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

/// The central comparison repeated with one parameter of the hand multiplied by `factor`.
struct HandVariation {
    std::string parameter;
    double factor = 1.0;
    std::vector<StudyRow> rows;  ///< at least those of the centre's condition and of `none`
};

struct StudyReport {
    std::string command;     ///< with which anyone makes this report again
    std::string version;     ///< version of this program
    std::string phantom;     ///< the annotated volume, in a sentence
    std::string annotators;  ///< how they are modelled, in sentences
    StudyCondition centre;   ///< around which one factor at a time is varied; its task is ignored
    std::vector<StudyRow> rows;
    std::vector<HandParameter> hand;
    std::vector<HandVariation> variations;
    std::vector<StudyRepeat> repeats;
    std::vector<BaselineRow> baselines;
    std::string no_baselines;  ///< why there are none, if so
};

std::string page_of(const StudyReport& report);

/// The condition without touch with which a condition is compared: of the same task, noise and probe, and of the same
/// law if there is one. Null if the rows have none.
const StudyCondition* base_of(const StudyCondition& condition, const std::vector<StudyCondition>& conditions);

/// "object, default law, ball of 1.5 radii, noise 10 %"
std::string words_of(const StudyCondition& condition);

/// The study's answer for one task, in a sentence with a number, its interval and the number of pairs; empty without
/// rows of both conditions.
std::string claim_of(const StudyReport& report, StudyTask task);

}  // namespace shvr
