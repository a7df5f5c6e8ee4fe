#pragma once
// What is under the probe and under the pointer: plain data of the model. Any thread.

#include <optional>

#include <glm/glm.hpp>

namespace shvr::ui {

/// Where the mouse is, over a pane of the picture.
struct Pointer {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool operator==(const Pointer&) const = default;
};

/// What the volume and the annotation have at a point.
struct Reading {
    glm::dvec3 voxel{0.0};            ///< of the probe; over a slice, of the pointer
    bool is_inside = false;           ///< the volume; otherwise nothing of the next three is known
    std::optional<double> intensity;  ///< in the file's units; null: it cannot be read, or is not read yet
    double offset = 0.0;              ///< that density painting added there
    uint8_t group = 0;
    /// Physical units, along the view, from where what is drawn of the volume begins. Of the probe, in the first pane.
    double depth = 0.0;
    /// Of the probe's ball: the share of its voxels at or above the threshold; null: not known.
    std::optional<double> relevant_share;
};

}  // namespace shvr::ui
