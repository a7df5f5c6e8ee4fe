#pragma once
// The line above the curve, for choosing a whole transfer function: the built-in ones and the user's own.

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

void preset_line(const Model& model, Actions& actions);

}  // namespace shvr::ui
