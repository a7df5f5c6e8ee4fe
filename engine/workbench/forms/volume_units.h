#pragma once
// Units that dialogs show and offer for a volume. Pure; any thread.

#include <string>

#include "engine/volume/volume.h"

namespace shvr::ui {

/// Returns the unit of lengths in words: "voxels", "µm", "mm".
std::string unit_of_lengths(const VolumeInfo& volume);
/// Returns whether the volume states a length, so that a part of it has a size in mm³.
bool has_cubic_millimetres(const VolumeInfo& volume);

}  // namespace shvr::ui
