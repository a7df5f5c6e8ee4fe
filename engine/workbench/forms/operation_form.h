#pragma once
// What the window of operations suggests, and its refusals in the words of its rows. Pure; any thread.

#include <string>

#include "engine/volume/volume.h"

namespace shvr::ui {

/// Returns the lowest intensity to suggest for what is at or above a threshold. For scans of integers it is a whole
/// number, which the same voxels reach; otherwise it has six digits.
double suggested_intensity(double threshold, VoxelType type);

/// Returns the refusal of a key with the label of its row: "From is empty; expected ..." for "key from is missing;
/// expected ...". Other texts stay as they are.
std::string with_label(const std::string& refusal);

}  // namespace shvr::ui
