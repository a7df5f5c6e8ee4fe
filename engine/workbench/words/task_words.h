#pragma once
// What a task of a person has done, in a sentence. Pure; any thread, except where a function asks the disk.

#include <span>
#include <string>
#include <vector>

#include "engine/tasks/evaluate_task.h"
#include "engine/tasks/label_task.h"

namespace shvr::ui {

/// "Exported leaf-mask.nrrd and leaf-trace.swc to /scans (17 MB)"; files in several folders keep their paths. `bytes`:
/// of all of them; 0: unknown.
std::string exported_in_words(std::span<const std::string> written, double bytes);
/// Returns the bytes of these files, and of those below these folders. Asks the disk.
double bytes_of_files(std::span<const std::string> paths);
/// "Found 12 connected parts at or above 120, the largest of 4096 voxels"
std::string labelled_in_words(const Components::Counts& counts, const LabelTask& task);
std::string compared_in_words(const EvaluateResult& result);

}  // namespace shvr::ui
