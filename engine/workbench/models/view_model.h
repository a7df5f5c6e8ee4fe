#pragma once
// What view, probe and hand show.

#include <optional>
#include <span>
#include <vector>

#include "engine/live/screen.h"
#include "engine/session/session.h"
#include "engine/workbench/models/sight.h"
#include "haptics/servo.h"

namespace shvr::ui {

struct HandView;

/// Made by the viewer.
struct ViewModel {
    const std::vector<Screen::Part>& panes;
    const Screen* screen = nullptr;            ///< null where nothing is open
    std::optional<Pointer> pointer{};          ///< the mouse, while it is over the picture
    std::optional<glm::dvec3> picked_pivot{};  ///< volume space; what turning goes about, if the session says so
    bool view_is_complete = true;
    bool view_is_limited = false;  ///< coarser than the screen, because the visible bricks exceed the budget
};

/// Made by the reader. Lengths in voxels.
struct ReadingModel {
    Reading reading{};
    std::span<const Measurement> measurements{};
    std::optional<glm::dvec3> measuring_from{};  ///< the first end of one that has no second yet
    std::optional<glm::dvec3> measuring_to{};    ///< where its second end would be now
};

/// Made by the prober.
struct ProbeModel {
    glm::dvec3 probe_voxel{0.0};
    glm::dvec3 tool_voxel{0.0};              ///< where tools act: the probe, or what it touches (FeelSettings)
    std::optional<uint32_t> tool_node;       ///< the node that they act at
    std::optional<uint32_t> tool_internode;  ///< the internode that they act on
};

/// Made by the hand.
struct TouchedModel {
    const ServoState* servo = nullptr;  ///< null while no servo runs
    const HandView* hand = nullptr;     ///< devices and what the hand does; null where nothing is open
    double relevance_age_ms = 0.0;      ///< age of the patch that the servo uses; 0 without assistance
};

}  // namespace shvr::ui
