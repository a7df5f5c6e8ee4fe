#pragma once
// Scores of an annotation, by the measures of `shvr evaluate`. Any thread.

#include "engine/annotation/work/change.h"
#include "engine/study/rows.h"
#include "engine/study/scene.h"

namespace shvr {

/// Writes the scores of the row's task: Dice scores of paint, scores and errors of a trace. As in the thesis, nodes are
/// held against all bundles. Numbers of an empty annotation are 0; shares and distances of nothing stay NaN.
void put_scores(const StudyScene& scene, const Document& document, StudyRow& row);

}  // namespace shvr
