#pragma once
// The line above the curve: whole transfer functions to start from, and the user's own.

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

void preset_line(const Model& model, Actions& actions);

}  // namespace shvr::ui
