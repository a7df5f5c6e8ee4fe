#pragma once
// Handles of the oblique cutting plane: one moves it along its normal, one tilts it. Pure; any thread.

#include <optional>
#include <utility>
#include <vector>

#include "engine/look/panes.h"
#include "engine/look/settings.h"
#include "engine/workbench/sight/handle_at.h"

namespace shvr::ui {

struct PlaneHandle {
    enum class Kind { move, tilt };
    Kind kind = Kind::move;
    glm::dvec2 at{0.0};  ///< pixels of the pane
    bool operator==(const PlaneHandle&) const = default;
};

/// A line over a pane, in pixels of the pane.
using PaneLine = std::pair<glm::dvec2, glm::dvec2>;

/// Returns the handles in a pane, the one that moves first; none without a plane, in maps, in anaglyphs, and in slices
/// that the plane does not cross. The handle that tilts is at the tip of the normal. The one that moves is at its foot
/// or, where the normal points along the line of sight, below it: dragged up, it pushes the plane away.
std::vector<PlaneHandle> plane_handles(const Pane& pane, const CutBox& cut, const VolumeInfo& volume);
/// Returns the cut after a drag of a handle from one pixel to another. `cut` is the cut before the drag. The handle, or
/// in slices the plane's line, follows the pointer. Moving keeps the normal, as far as the plane meets the volume.
CutBox dragged(const CutBox& cut, const PlaneHandle& handle, const Pane& pane, const VolumeInfo& volume,
               const glm::dvec2& from, const glm::dvec2& to);
/// Returns lines that show the plane: where it crosses the slice or the edges of the uncut box, and its normal, from
/// which it removes the volume.
std::vector<PaneLine> plane_lines(const Pane& pane, const CutBox& cut, const VolumeInfo& volume);
/// Returns the cut with a plane that removes the half towards the viewer: through the camera's target or, if that is
/// cut away, through the middle of the uncut box.
CutBox cut_facing(const CutBox& cut, const Camera& camera, const VolumeInfo& volume);

}  // namespace shvr::ui
