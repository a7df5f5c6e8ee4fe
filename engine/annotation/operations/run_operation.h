#pragma once
// Computes what an operation changes. Nothing is changed here: the records become one command of the history. Any
// thread, on a copy of the mask.

#include "engine/annotation/operations/mask_edit.h"
#include "engine/annotation/operations/operations.h"
#include "engine/base/progress.h"

namespace shvr {

/// Fails, naming the key, the value and what was expected, if the operation is not possible here. An exception from
/// `progress` ends the operation.
OperationResult run(const GroupOperation& operation, const OperationInput& input, const Progress& progress = {});

/// The step's name in the history: "fill holes, group 3".
std::string label_of(const GroupOperation& operation);
/// Whether the operation reads intensities.
bool needs_intensities(const GroupOperation& operation);

// The function of each row; called by `run` only.
void perform(const CombineOp& op, MaskEdit& edit, const Progress& progress);
void perform(const IslandsOp& op, MaskEdit& edit, const Progress& progress);
void perform(const FillHolesOp& op, MaskEdit& edit, const Progress& progress);
void perform(const FillBetweenOp& op, MaskEdit& edit, const Progress& progress);
void perform(const ThresholdOp& op, MaskEdit& edit, const Progress& progress);
void perform(const GrowOp& op, MaskEdit& edit, const Progress& progress);
void perform(const ShrinkOp& op, MaskEdit& edit, const Progress& progress);
void perform(const OpenOp& op, MaskEdit& edit, const Progress& progress);
void perform(const CloseOp& op, MaskEdit& edit, const Progress& progress);
void perform(const HollowOp& op, MaskEdit& edit, const Progress& progress);
void perform(const SmoothOp& op, MaskEdit& edit, const Progress& progress);
void perform(const MaskFromTraceOp& op, MaskEdit& edit, const Progress& progress);
void perform(const TraceFromMaskOp& op, MaskEdit& edit, const Progress& progress);

}  // namespace shvr
