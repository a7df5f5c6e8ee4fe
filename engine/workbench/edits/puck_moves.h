#pragma once
// Motion of a device that reports speeds, as actions of the view. Pure; any thread.

#include "engine/workbench/actions/action.h"
#include "haptics/device.h"

namespace shvr::ui {

/// Moves the view for `seconds`: the picture follows the puck. Full deflection moves it by its height, or
/// rotates it by 90 degrees, per second. Empty while the puck rests.
Actions moves_of_puck(const DeviceState& state, double seconds);

}  // namespace shvr::ui
