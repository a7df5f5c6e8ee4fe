#pragma once
// Draws the forms of tasks (engine/workbench/forms): four rows, and the other options under More. Between
// Window::begin_ui and Window::present, main thread.

#include <optional>
#include <string>

#include "engine/tasks/evaluate_task.h"
#include "engine/tasks/import_estimate.h"
#include "engine/workbench/forms/export_form.h"
#include "engine/workbench/forms/import_form.h"
#include "engine/workbench/forms/label_form.h"

namespace shvr::ui {

/// The form of a comparison is its table of fields.
struct CompareForm {
    EvaluateTask task{.names = OptionNames::titles};
};

/// What is known about the scan that an import reads; null: not yet.
using KnownScan = std::optional<ImportEstimate>;

/// Draw the rows and change the form. `begins`: gives the keyboard to the first field, with all text typed from now on.
/// Return whether a chooser of one of the fields was in front: an Escape or Enter was for that chooser.
bool draw_form(ExportForm& form, const Model& model, const KnownScan& known, bool begins);
bool draw_form(ImportForm& form, const Model& model, const KnownScan& known, bool begins);
bool draw_form(LabelForm& form, const Model& model, const KnownScan& known, bool begins);
bool draw_form(CompareForm& form, const Model& model, const KnownScan& known, bool begins);

/// Return what the task will do, in a sentence below the rows.
std::string about(const ExportForm& form, const Model& model, const KnownScan& known);
std::string about(const ImportForm& form, const Model& model, const KnownScan& known);
std::string about(const LabelForm& form, const Model& model, const KnownScan& known);
std::string about(const CompareForm& form, const Model& model, const KnownScan& known);

}  // namespace shvr::ui
