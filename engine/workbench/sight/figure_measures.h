#pragma once
// Measurements in figures: lines, points, names and values. Pure; any thread, except for the drawer of texts.

#include <span>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "engine/workbench/sight/figure_pane.h"
#include "engine/workbench/sight/label_place.h"

namespace shvr::ui {

/// Draws the measurements that a pane shows. Their labels cover no element that is drawn already, and are near their
/// lines or have a thin line to them; those without room are left out. `left_out`: receives a sentence about labels
/// that are shortened or left out and, if the pane is the first one, about measurements that cannot be seen. `memory`:
/// where labels were in the last frame of a movie, renewed; null: none.
void draw_measurements(FigurePane& drawn, const Pane& pane, std::span<const Measurement> all, const VolumeInfo& volume,
                       LabelMemory* memory, bool is_first, std::vector<std::string>& left_out);

}  // namespace shvr::ui
