#pragma once
// Handles of the clip box in a pane: one for each face, in slices one for each edge that the slice shows. Pure; any
// thread.

#include <optional>
#include <vector>

#include "engine/look/panes.h"
#include "engine/look/settings.h"
#include "engine/workbench/sight/handle_at.h"

namespace shvr::ui {

struct CutHandle {
    int axis = 0;
    bool upper = false;      ///< the far face
    glm::dvec2 at{0.0};      ///< pixels of the pane
    glm::dvec3 middle{0.0};  ///< middle of the face, in volume space
    double voxel = 0.0;      ///< position of the face along the axis
    bool operator==(const CutHandle&) const = default;
};

/// Returns the handles that can be dragged in a pane: none in maps and anaglyphs, and none of a face whose axis the
/// pane sees end on. If the handles of two faces nearly coincide, returns the one that has more room outwards.
std::vector<CutHandle> cut_handles(const Pane& pane, const CutBox& cut, const VolumeInfo& volume);
/// Returns the box after a drag of a handle from one pixel to another. `cut` is the box before the drag. The face
/// follows the pointer as far as the volume's end, and to one voxel before the other face.
CutBox dragged(const CutBox& cut, const CutHandle& handle, const Pane& pane, const VolumeInfo& volume,
               const glm::dvec2& from, const glm::dvec2& to);
/// Returns the edges of the box in a slice, as the corners of a rectangle in pixels of the pane.
std::vector<glm::dvec2> box_in_slice(const Pane& pane, const CutBox& cut, const VolumeInfo& volume);

/// Returns the position on the line from `origin` along the unit vector `along` that is nearest to the line of sight
/// through a pixel, as a distance from `origin`; null if the two are parallel.
std::optional<double> place_along(const Pane& pane, const glm::dvec3& origin, const glm::dvec3& along,
                                  const glm::dvec2& pixel);

}  // namespace shvr::ui
