#pragma once
// The dialog Label connected parts: the threshold, neighbours, the smallest part, and the file of labels. Pure; any
// thread.

#include <string>

#include "engine/tasks/label_task.h"
#include "engine/workbench/forms/disk_space.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct LabelForm {
    bool writes_labels = false;                    ///< otherwise parts are only counted
    std::string output;                            ///< as typed
    LabelTask more{.names = OptionNames::titles};  ///< all other options; those of the rows too
};

/// Returns a form that counts the parts at or above the paint threshold; its file is suggested.
LabelForm suggested_label(const Model& model);
/// Returns why the form cannot be carried out; empty: it can.
std::string why_not(const LabelForm& form);
/// `folder`: where relative names lie.
LabelTask task_of(const LabelForm& form, const std::filesystem::path& folder);
/// Returns how much the file of labels takes at most: "at most 17 MB".
std::string size_of_labels(const LabelForm& form, const Model& model);
BytesNeeded bytes_written(const LabelForm& form, const Model& model);
inline constexpr std::string_view LABEL_ROWS_COVER[]{"threshold", "connectivity", "min_voxels", "output"};

}  // namespace shvr::ui
