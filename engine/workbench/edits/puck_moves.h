#pragma once
// Converts the motion of a device that reports speeds (a SpaceMouse's puck) to actions on the view. Pure; any thread.

#include "engine/workbench/actions/action.h"
#include "haptics/device.h"

namespace shvr::ui {

/// Returns actions that move the view as far as the puck moves it in `seconds`: at full deflection, the picture moves
/// by its height or rotates by 90 degrees per second. Returns no actions while the puck is at rest.
Actions moves_of_puck(const DeviceState& state, double seconds);

}  // namespace shvr::ui
