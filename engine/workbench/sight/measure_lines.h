#pragma once
// The lines of a measurement in a pane and the place of its label, on the screen as in figures. Pure; any thread.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/look/panes.h"
#include "engine/session/session.h"
#include "engine/workbench/sight/label_place.h"

namespace shvr::ui {

/// Pixels of the pane.
struct MeasureLines {
    /// What is in front of the camera; in slices, sides that cross the plane or come within a voxel of it.
    std::vector<LabelLine> sides;
    /// Stands behind the value: " (seen in part)" if other sides are not in the slice, or are behind the camera;
    /// " (through the slice)" if a side leaves the slice, so that it is longer than drawn.
    std::string_view note;
    bool is_last_open = false;        ///< the last of `sides` is not set yet
    std::vector<LabelLine> arc;       ///< between the sides of an angle, in short pieces; empty: not seen, or no angle
    std::optional<LabelPlace> label;  ///< null: no side is in the pane
};

/// `is_open`: the last point of the measurement is not set yet. `units`: pixels per unit of the interface.
MeasureLines lines_of(const Measurement& measured, const Pane& pane, const VolumeInfo& volume, double units,
                      bool is_open = false);

/// The parts of the label "Path 2: 1.25 mm", in one line; a long name is cut. `number` counts from 1.
struct MeasureLabel {
    std::string name, value;
    std::string text() const { return name.empty() ? value : name + ": " + value; }
};
MeasureLabel label_of(const Measurement& measured, size_t number, const VolumeInfo& volume);

}  // namespace shvr::ui
