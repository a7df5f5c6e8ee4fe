#pragma once
// Imports and labels by several processes: each makes a piece, and one joins them to what a single process makes. Any
// thread.

#include <vector>

#include "engine/pieces/task_choice.h"
#include "engine/tasks/import_task.h"
#include "engine/tasks/label_task.h"

namespace shvr {

/// Checks like `check`, and refuses options that several processes cannot have.
void check_part(const ImportTask& task);
/// For one of several processes: imports its part of the slices to `piece` (engine/projects/import_piece.h). A stopped
/// task keeps its finished chunks, and repeating it resumes it.
void run_part(const ImportTask& task, const TaskChoice& choice, const std::filesystem::path& piece,
              ProgressReporter& reporter);
/// Joins the pieces of all processes to the project that `run` makes.
ImportResult join_parts(const ImportTask& task, const std::vector<std::filesystem::path>& pieces,
                        ProgressReporter& reporter);

/// For one of several processes: labels its part of the slices, whole blocks of the source, and writes it to `piece`,
/// which appears once it is complete.
void run_part(const LabelTask& task, const VolumeSource& source, const std::string& name, const TaskChoice& choice,
              const std::filesystem::path& piece, ProgressReporter& reporter);
/// Joins the parts of all processes, in order, and writes what `run` writes.
LabelResult join_parts(const LabelTask& task, const VolumeSource& source, const std::string& name,
                       const std::vector<std::filesystem::path>& pieces, ProgressReporter& reporter);

}  // namespace shvr
