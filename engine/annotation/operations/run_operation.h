#pragma once
// Computes an operation's changes as records without changing anything itself; the caller adds the records to the
// history as one command. Any thread may call these on a copy of the mask.

#include "engine/annotation/operations/mask_edit.h"
#include "engine/annotation/operations/operations.h"
#include "engine/base/progress.h"

namespace shvr {

/// Fails if the operation is not possible here, naming the key, its value and the expected value. An exception from
/// `progress` cancels the operation.
OperationResult run(const GroupOperation& operation, const OperationInput& input, const Progress& progress = {});

/// The step's name in the history: "fill holes, group 3".
std::string label_of(const GroupOperation& operation);
/// Whether the operation reads intensities.
bool needs_intensities(const GroupOperation& operation);

// The function that performs each row's operation; called by `run` only.
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
void perform(const GrowSeedsOp& op, MaskEdit& edit, const Progress& progress);
void perform(const LassoOp& op, MaskEdit& edit, const Progress& progress);
void perform(const MaskFromTraceOp& op, MaskEdit& edit, const Progress& progress);
void perform(const TraceFromMaskOp& op, MaskEdit& edit, const Progress& progress);

}  // namespace shvr
