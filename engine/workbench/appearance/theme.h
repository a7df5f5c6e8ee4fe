#pragma once
// Colours of the interface, named by purpose, in two themes. Text is readable on every surface: the contrast, as
// defined by WCAG 2.1, is at least MIN_TEXT_CONTRAST, even for greyed widgets (tests/unit/ui/theme_test.cpp). Pure; any
// thread.

#include <array>
#include <span>

#include "engine/base/spelling.h"

namespace shvr::ui {

enum class Theme { dark, light };
inline constexpr Spelling<Theme> THEMES[] = {{Theme::dark, "dark"}, {Theme::light, "light"}};
constexpr std::span<const Spelling<Theme>> spellings_of(Theme)
{
    return THEMES;
}

/// sRGB, 0 ... 1, opaque.
using Shade = std::array<float, 3>;

enum class ColorRole {
    // Texts
    text,
    faint_text,  ///< hints, keys, disabled items
    warning,     ///< colour of a warning mark; its meaning is given by a word or icon next to the mark
    error,
    accent_text,  ///< headings
    // Surfaces that texts stand on
    window,
    popup,
    bar,  ///< menu, tools, status
    frame,
    frame_hovered,
    frame_active,
    button,
    button_hovered,
    button_active,
    header,
    header_hovered,
    header_active,
    chosen,  ///< the item in use among several
    selection,
    table_header,
    notice,
    // Drawings
    accent,
    accent_strong,
    line,
    border,
    separator,
    scrollbar,
    scrollbar_hovered,
    scrollbar_active,
    chart,
    chart_bars,
    chart_line,
    chart_paint,
    chart_felt,
    COUNT
};

inline constexpr double MIN_TEXT_CONTRAST = 4.5;
/// Opacity at which a greyed widget is blended over the window's surface.
inline constexpr float DISABLED_SHARE = 0.75f;

Shade shade_of(ColorRole role, Theme theme);
std::span<const ColorRole> text_roles();
std::span<const ColorRole> surface_roles();

/// Returns (L1 + 0.05) / (L2 + 0.05), 1 ... 21, where L1 >= L2 are the relative luminances.
double contrast(const Shade& a, const Shade& b);
/// Blends `over` onto `below` with weight `share` (and 1 - share for `below`), as the device does.
Shade blended(const Shade& over, const Shade& below, float share);

}  // namespace shvr::ui
