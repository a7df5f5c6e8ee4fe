#include "engine/workbench/edits/puck_moves.h"

namespace shvr::ui {

namespace {

constexpr double HEIGHTS_PER_S = 1.0, DEGREES_PER_S = 90.0;  ///< at full deflection

}  // namespace

Actions moves_of_puck(const DeviceState& state, double seconds)
{
    Actions actions;
    const glm::dvec3 along = HEIGHTS_PER_S * seconds * state.rate, about = DEGREES_PER_S * seconds * state.turn_rate;
    // The picture follows the puck, so the camera moves in the opposite direction: forwards if the puck comes nearer.
    if (along != glm::dvec3(0.0)) actions.push_back(Move{{-along.x, -along.y, along.z}});
    if (about.x != 0.0 || about.y != 0.0) actions.push_back(Orbit{-about.y, about.x});
    if (about.z != 0.0) actions.push_back(Roll{-about.z});
    return actions;
}

}  // namespace shvr::ui
