#pragma once
// Values read at the probe and at the pointer: plain data of the model. Any thread.

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
    glm::dvec3 voxel{0.0};            ///< position of the probe; over a slice, position of the pointer
    bool is_inside = false;           ///< inside the volume; if false, the next three members are unknown
    std::optional<double> intensity;  ///< in the file's units; null: it cannot be read, or has not been read yet
    double offset = 0.0;              ///< density offset added by painting
    uint8_t group = 0;
    /// Depth of the probe in the first pane: physical units along the view, from where the drawn volume begins.
    double depth = 0.0;
    /// Fraction of the voxels in the probe's ball whose value is at or above the threshold; null: unknown.
    std::optional<double> relevant_share;
};

}  // namespace shvr::ui
