#pragma once
// The table of panels, from top to bottom. ui/panels checks at compile time that each row has a function to draw it.

#include "engine/workbench/appearance/layout.h"

namespace shvr::ui {

// The curve and the groups come first, so that both are visible at 1280 x 800 without scrolling.
inline constexpr PanelRow PANELS[] = {
    {.id = "transfer_function", .title = "Transfer function", .hint = "Colour and opacity of intensities."},
    {.id = "groups", .title = "Colour groups", .hint = "What paint and traces belong to."},
    {.id = "probe", .title = "Brush and probe", .hint = "What a stroke paints."},
    {.id = "touch",
     .title = "Touch and guidance",
     .hint = "Felt structures, guidance force and haptic device.",
     .is_folded = true},
    {.id = "trace", .title = "Tracing", .hint = "Nodes, internodes and what is selected."},
    {.id = "trace_list", .title = "Tracing list", .hint = "All segments and nodes, to go to.", .is_folded = true},
    {.id = "measurements", .title = "Measurements", .hint = "Distances, paths and angles, to name and export."},
    {.id = "meshes", .title = "Meshes", .hint = "Surfaces of files, shown with the scan.", .is_folded = true},
    {.id = "light", .title = "Light and depth", .hint = "Light, highlight and distance blending.", .is_folded = true},
    {.id = "occlusion", .title = "Ambient occlusion", .hint = "Soft shade in hollows.", .is_folded = true},
    {.id = "cuts", .title = "Cutting planes", .hint = "Limits of the visible part, in numbers.", .is_folded = true},
    {.id = "quality", .title = "Render quality", .hint = "Exactness against time.", .is_folded = true},
    {.id = "aids", .title = "What is shown", .hint = "Volume, nodes, probe, scale bar and axes.", .is_folded = true},
    {.id = "views", .title = "Views", .hint = "Panes, slices and how fast the picture follows.", .is_folded = true},
    {.id = "history", .title = "History", .hint = "All steps, to go back to any of them.", .is_folded = true},
};

}  // namespace shvr::ui
