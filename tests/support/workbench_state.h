#pragma once
// The observable state of a workbench, key by key, so that a test can state what an action must change, and that
// nothing else does; and a small scan to work on. One thread, the renderer's.

#include <filesystem>
#include <map>
#include <string>

#include "engine/workbench/workbench.h"

namespace shvr::test {

/// "light" -> {"ambient":0.3,...}, "voxels" -> "1:144 3:20", "camera", "nodes", "file scan.mask", ...
using State = std::map<std::string, std::string>;
/// Files in `folder` belong to the state, by name and content.
State state_of(const ui::Workbench& bench, const std::filesystem::path& folder);
/// The keys that differ, in order, separated by commas.
std::string difference(const State& before, const State& after);
/// Everything that undo and redo bring back, bit for bit: paint, offsets, trace and lasting settings, as bytes.
std::string lasting_state(const ui::Workbench& bench);

/// A session of a procedural scan of tubes in that folder, without annotation. Returns its path.
std::filesystem::path write_tubes_session(const std::filesystem::path& folder);
/// Advances the workbench until no work is left; an open stroke stays open.
void settle(ui::Workbench& bench);

}  // namespace shvr::test
