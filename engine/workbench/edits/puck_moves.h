#pragma once
// Moves of a device that states speeds, as actions of the view. Pure; any thread.

#include "engine/workbench/actions/action.h"
#include "haptics/device.h"

namespace shvr::ui {

/// Moves the view for `seconds`: what is seen follows the puck. Full deflection moves it by its height, or
/// rotates it by 90 degrees, per second. Empty where the puck rests.
Actions moves_of_puck(const DeviceState& state, double seconds);

}  // namespace shvr::ui
