#pragma once
// View of camera, probe and hand.

#include <optional>
#include <span>
#include <string>
#include <utility>
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
    std::optional<Pointer> pointer{};          ///< position of the mouse while it is over the picture; otherwise null
    std::optional<glm::dvec3> picked_pivot{};  ///< pivot picked by the user, in volume space; settings select its use
    bool view_is_complete = true;
    bool view_is_limited = false;  ///< drawn coarser than the screen: visible bricks exceed the memory budget
};

/// Made by the shower of meshes.
struct MeshModel {
    /// Those that cannot be shown: MeshLook::file, and a sentence.
    std::span<const std::pair<std::string, std::string>> unshown_meshes;
};

/// Made by the reader. Lengths in voxels.
struct ReadingModel {
    Reading reading{};
    std::span<const Measurement> measurements{};
    std::span<const glm::dvec3> measuring{};   ///< points of a measurement that is begun and not complete yet
    std::optional<glm::dvec3> measuring_to{};  ///< candidate for its next point
};

/// Made by the prober.
struct ProbeModel {
    glm::dvec3 probe_voxel{0.0};
    glm::dvec3 tool_voxel{0.0};              ///< where tools act: at the probe, or where they snap to a structure
                                             ///< (FeelSettings)
    std::optional<uint32_t> tool_node;       ///< node that tools act at
    std::optional<uint32_t> tool_internode;  ///< internode that tools act on
};

/// Made by the hand.
struct TouchedModel {
    const ServoState* servo = nullptr;  ///< null while no servo runs
    const HandView* hand = nullptr;     ///< the haptic device and its state; null while nothing is open
    double relevance_age_ms = 0.0;      ///< age of the relevance data that the servo uses; 0 without assistance
};

}  // namespace shvr::ui
