#pragma once
// Rows of the window of operations that limit which voxels may change: intensities, a group, unpainted voxels, and a
// region. All operations share them. Between Window::begin_ui and Window::present, main thread.

#include <optional>
#include <string>

#include "engine/workbench/actions/group_actions.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// A row with a group, by colour, number and name. `none`: the text of a first entry, which makes it null; null: there
/// is no such entry. `has_unpainted`: lists 0, too.
void group_row(const char* name, std::optional<int64_t>& group, const Model& model, const char* none,
               bool has_unpainted);
void group_row(const char* name, int64_t& group, const Model& model, bool has_unpainted = false);

/// Draws the rows, and takes what they say into `limits`. `clicked`: a voxel that was clicked, around which a box goes.
/// `limits_intensities`: false leaves out the range of intensities, for an operation that has one itself. Returns why
/// the operation cannot be limited like this; empty: it can.
std::string limit_rows(OperationLimits& limits, const Model& model, const std::optional<glm::dvec3>& clicked,
                       bool limits_intensities);
/// Whether the next click in the picture places the box.
bool limit_rows_take_clicks();

}  // namespace shvr::ui
