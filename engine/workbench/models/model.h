#pragma once
// A read-only view of the workbench, for panels, keys and conditions of actions; each service contributes one part. It
// consists of references and a few numbers, so it is cheap to make. Valid until the next action or main-loop step.

#include "engine/workbench/models/document_model.h"
#include "engine/workbench/models/opening_model.h"
#include "engine/workbench/models/view_model.h"
#include "engine/workbench/models/window_model.h"
#include "engine/workbench/models/work_model.h"

namespace shvr::ui {

struct Model : DocumentModel,
               ViewModel,
               ReadingModel,
               ProbeModel,
               TouchedModel,
               PaintModel,
               OperationModel,
               TraceModel,
               HistoryModel,
               SaveModel,
               OpeningModel,
               CandidateModel,
               JobModel,
               PreferenceModel,
               PresetModel,
               WindowModel,
               ReportModel,
               LookModel,
               MeshModel {
    const BrushSettings& brush() const { return session.probe.brush; }
    double paint_threshold() const { return brush().threshold.value_or(0.0); }
    double haptic_threshold() const { return session.probe.haptic_threshold.value_or(0.0); }
    Tool tool() const { return session.probe.tool; }
    const std::string& status() const { return messages.last(); }
};

/// Returns the words of the status bar for the save state; a scan that was never saved does not count as "saved".
inline const char* saved_in_words(const Model& model)
{
    if (model.is_saving) return "saving";
    if (!model.is_saved) return "not saved";
    return model.has_session_file ? "saved" : "no project yet";
}

}  // namespace shvr::ui
