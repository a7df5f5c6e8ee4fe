#pragma once
// Positions of the panels, and the part of the window that remains for the picture. Lengths are in font sizes unless
// stated otherwise, so that a layout fits every scale. Pure; any thread.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <glm/vec2.hpp>

#include "engine/base/spelling.h"

namespace shvr::ui {

/// `side`: in the column at the right; `floating`: in a window of its own; `hidden`: not shown.
enum class PanelPlace { side, floating, hidden };
inline constexpr Spelling<PanelPlace> PANEL_PLACES[] = {
    {PanelPlace::side, "side"}, {PanelPlace::floating, "floating"}, {PanelPlace::hidden, "hidden"}};
constexpr std::span<const Spelling<PanelPlace>> spellings_of(PanelPlace)
{
    return PANEL_PLACES;
}

struct PanelRow {
    const char* id = "";     ///< never changes: preferences refer to it
    const char* title = "";  ///< title in menus, headings and help
    const char* hint = "";   ///< purpose of the panel
    PanelPlace place = PanelPlace::side;
    bool is_folded = false;
};
/// From top to bottom.
std::span<const PanelRow> panel_rows();
/// Null where there is none.
const PanelRow* panel_named(std::string_view id);

/// The user's changes to a panel's layout; members without a value keep their defaults.
struct PanelLayout {
    std::optional<PanelPlace> place;
    std::optional<bool> folded;
    std::optional<glm::dvec2> at, size;  ///< position (of the upper left corner) and size if floating
    bool operator==(const PanelLayout&) const = default;
};

/// Last position and size of a window such as help or messages; those of the program's own window ("main") are in the
/// screen's units.
struct WindowPlace {
    std::optional<glm::dvec2> at, size;
    bool operator==(const WindowPlace&) const = default;
};
inline constexpr const char* MAIN_WINDOW = "main";
inline constexpr const char* WINDOW_IDS[] = {MAIN_WINDOW, "help", "messages", "passes", "operations"};

inline constexpr double SIDE_WIDTH = 25.0, MIN_SIDE_WIDTH = 17.0;
inline constexpr double MAX_SIDE_SHARE = 0.5;  ///< share of the window's width
inline constexpr glm::dvec2 FLOATING_SIZE{26.0, 30.0};

struct WindowLayout {
    std::map<std::string, PanelLayout> panels;   ///< by id
    std::map<std::string, WindowPlace> windows;  ///< by one of WINDOW_IDS
    std::optional<double> side_width;
    bool shows_side = true, shows_tool_bar = true;

    PanelPlace place_of(const PanelRow& row) const;
    bool is_folded(const PanelRow& row) const;
    /// Returns whether any panel is in the column at the right.
    bool has_side() const;
    bool operator==(const WindowLayout&) const = default;
};

/// Width of the column of panels at the right, in window units: the chosen width, but at most half of the window.
double side_units(const WindowLayout& layout, double window_units, double font_units);

/// Returns the corner of a floating panel, moved so that its title can be reached in a window of the given size.
glm::dvec2 within_reach(const glm::dvec2& at, const glm::dvec2& size, const glm::dvec2& window);

}  // namespace shvr::ui
