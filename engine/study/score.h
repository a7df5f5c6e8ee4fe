#pragma once
// Scores of an annotation, computed by the measures of `shvr evaluate`. Any thread.

#include "engine/annotation/work/change.h"
#include "engine/study/rows.h"
#include "engine/study/scene.h"

namespace shvr {

/// Writes the scores of the row's task: Dice scores of a mask, or scores and errors of a trace. As in the thesis, nodes
/// are compared with all bundles. Counts for an empty annotation are 0; its ratios and distances are NaN.
void put_scores(const StudyScene& scene, const Document& document, StudyRow& row);

}  // namespace shvr
