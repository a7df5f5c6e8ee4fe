#pragma once
// Groups as a row to step through: those with a key, in use, or described. Pure; any thread.

#include <vector>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Ascending, without 0: groups with a key, described by the session, painted, traced or active.
std::vector<uint8_t> known_groups(const Model& model);
/// Of those, the next one above the active group (direction 1) or below (-1), around the end.
uint8_t next_group(const Model& model, int direction);
/// The first that nothing is painted, traced or described with; 0 where there is none.
uint8_t unused_group(const Model& model);

}  // namespace shvr::ui
