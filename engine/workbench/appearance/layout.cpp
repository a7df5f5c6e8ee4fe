#include "engine/workbench/appearance/layout.h"

#include <algorithm>

#include <glm/common.hpp>

namespace shvr::ui {

namespace {

// The curve and the groups come first, so that both are visible at 1280 x 800 without scrolling.
constexpr PanelRow PANELS[] = {
    {.id = "transfer_function", .title = "Transfer function", .hint = "Colour and opacity of intensities."},
    {.id = "groups", .title = "Colour groups", .hint = "What paint and traces belong to."},
    {.id = "probe", .title = "Brush and probe", .hint = "What a stroke paints."},
    {.id = "touch",
     .title = "Touch and guidance",
     .hint = "Felt structures, guidance force and haptic device.",
     .is_folded = true},
    {.id = "trace", .title = "Tracing", .hint = "Nodes, internodes and what is selected."},
    {.id = "trace_list", .title = "Tracing list", .hint = "All segments and nodes, to go to.", .is_folded = true},
    {.id = "light", .title = "Light and depth", .hint = "Light, highlight and distance blending.", .is_folded = true},
    {.id = "occlusion", .title = "Ambient occlusion", .hint = "Soft shade in hollows.", .is_folded = true},
    {.id = "cuts", .title = "Cutting planes", .hint = "Limits of the visible part, in numbers.", .is_folded = true},
    {.id = "quality", .title = "Render quality", .hint = "Exactness against time.", .is_folded = true},
    {.id = "aids", .title = "What is shown", .hint = "Volume, nodes, probe, scale bar and axes.", .is_folded = true},
    {.id = "views", .title = "Views", .hint = "Panes, slices and how fast the picture follows.", .is_folded = true},
    {.id = "history", .title = "History", .hint = "All steps, to go back to any of them.", .is_folded = true},
};

}  // namespace

std::span<const PanelRow> panel_rows()
{
    return PANELS;
}

const PanelRow* panel_named(std::string_view id)
{
    const auto found = std::ranges::find_if(PANELS, [&](const PanelRow& row) { return row.id == id; });
    return found == std::end(PANELS) ? nullptr : &*found;
}

PanelPlace WindowLayout::place_of(const PanelRow& row) const
{
    const auto found = panels.find(row.id);
    return found == panels.end() ? row.place : found->second.place.value_or(row.place);
}

bool WindowLayout::is_folded(const PanelRow& row) const
{
    const auto found = panels.find(row.id);
    return found == panels.end() ? row.is_folded : found->second.folded.value_or(row.is_folded);
}

bool WindowLayout::has_side() const
{
    return shows_side &&
           std::ranges::any_of(PANELS, [&](const PanelRow& row) { return place_of(row) == PanelPlace::side; });
}

double side_units(const WindowLayout& layout, double window_units, double font_units)
{
    if (!layout.has_side()) return 0.0;
    const double wanted = font_units * std::max(layout.side_width.value_or(SIDE_WIDTH), MIN_SIDE_WIDTH);
    return std::min(wanted, MAX_SIDE_SHARE * window_units);
}

glm::dvec2 within_reach(const glm::dvec2& at, const glm::dvec2& size, const glm::dvec2& window)
{
    return glm::max(glm::min(at, window - glm::min(size, window)), glm::dvec2(0.0));
}

}  // namespace shvr::ui
