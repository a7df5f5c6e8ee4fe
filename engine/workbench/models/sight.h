#pragma once
// Values at the probe and at the mouse pointer, as plain data of the model. Any thread.

#include <optional>

#include <glm/glm.hpp>

namespace shvr::ui {

/// Position of the mouse over a pane of the picture.
struct Pointer {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool operator==(const Pointer&) const = default;
};

/// Values of the volume and the annotation at a point.
struct Reading {
    glm::dvec3 voxel{0.0};            ///< where values are read: under the mouse if over a slice, else at the probe
    bool is_inside = false;           ///< whether the voxel is in the volume; if not, the next three members are unset
    std::optional<double> intensity;  ///< in the file's units; null: could not be read, or is not read yet
    double offset = 0.0;              ///< density offset added by painting
    uint8_t group = 0;
    /// Depth of the probe in the first pane, in physical units along the view, from the start of the drawn volume.
    double depth = 0.0;
    /// Fraction of the voxels in the probe's ball whose values reach the threshold; null: unknown.
    std::optional<double> relevant_share;
};

}  // namespace shvr::ui
