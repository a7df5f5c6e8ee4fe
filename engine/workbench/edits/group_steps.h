#pragma once
// Steps through the known groups: those that have a key, are used, or are described. Pure; any thread.

#include <vector>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the groups that have a key, are described, painted, traced or active, in ascending order and without 0.
std::vector<uint8_t> known_groups(const Model& model);
/// Returns the next known group above the active group (direction 1) or below it (-1), with wrap-around.
uint8_t next_group(const Model& model, int direction);
/// Returns the first group that is not painted, traced or described; 0 if there is none.
uint8_t unused_group(const Model& model);

}  // namespace shvr::ui
