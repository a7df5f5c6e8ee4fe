#pragma once
// Converts the motion of a device that reports speeds to actions on the view. Pure; any thread.

#include "engine/workbench/actions/action.h"
#include "haptics/device.h"

namespace shvr::ui {

/// Moves the view for `seconds`: the picture follows the puck. At full deflection, the picture moves by its height, or
/// rotates by 90 degrees, per second. Returns no actions while the puck is at rest.
Actions moves_of_puck(const DeviceState& state, double seconds);

}  // namespace shvr::ui
