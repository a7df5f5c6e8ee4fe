#include "engine/workbench/appearance/layout.h"

#include <algorithm>

#include <glm/common.hpp>

#include "engine/workbench/appearance/panel_rows.h"

namespace shvr::ui {

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
