#pragma once
// Rows of the window of operations that its table of keys does not draw: lists of groups, and what a cut takes from the
// picture. Between Window::begin_ui and Window::present, main thread.

#include <optional>
#include <string>

#include "engine/workbench/actions/group_actions.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// A row with a list of groups, such as "1, 2"; empty: all. Changes `groups` while the text is a list of groups;
/// returns why it is not, otherwise nothing.
std::string groups_row(const char* name, std::string& text, std::vector<uint8_t>& groups, const Model& model);
/// Draws a length in the unit of the spacing.
void length_row(const char* name, double& length, const Model& model);
/// Draw lengths that may be left out: by how much centre lines may be off, and how far seeds may grow beyond their box.
void tolerance_row(std::optional<double>& tolerance, const Model& model);
void margin_row(std::optional<int64_t>& margin);

/// Draws the rows of islands. `clicked`: a voxel that was clicked in the picture. Only values that the chosen parts
/// need are in `op`, so that it is valid whatever is chosen. Returns what to do next; empty: nothing is missing.
std::string islands_rows(IslandsOp& op, const Model& model, const std::optional<glm::dvec3>& clicked);

/// Draws the rows of a cut, and takes what is drawn in the picture into it (outline_tool.h).
void cut_rows(LassoOp& op, const Model& model);
/// Draws the outline over the picture, while the view is the one in which it was drawn.
void draw_outline(const Model& model);

}  // namespace shvr::ui
