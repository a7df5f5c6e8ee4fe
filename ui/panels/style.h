#pragma once
// Colours, shapes and fonts of all panels. Main thread, between frames where nothing else is said.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <imgui/imgui.h>

#include "engine/workbench/appearance/theme.h"
#include "engine/workbench/sight/figure.h"

namespace shvr::ui {

struct Appearance {
    Theme theme = Theme::dark;
    double font_pixels = 14.0;  ///< at a scale of 1
    double scale = 1.0;         ///< of everything
    bool operator==(const Appearance&) const = default;
};

/// Sets the style and fills the font atlas anew. The back end uploads fonts when it is attached; later
/// Window::renew_fonts does.
void set_style(const Appearance& appearance);

/// Fills the font atlas (fonts.cpp).
void load_fonts(double pixels);

/// Letters of those fonts for pictures in files (figure.h), of a height in pixels.
std::vector<TextImage> draw_texts(std::span<const std::string> texts, double pixels);

/// A text that people wrote: names, paths, messages. Its characters are in the fonts from the next frame on, as far as
/// a font of this machine has them. Any time on the main thread; cheap.
void want_glyphs(std::string_view text);
/// The same for what was typed since the last frame.
void want_typed_glyphs();
/// Whether characters are wanted that the atlas does not hold; set_style fills it.
bool fonts_are_stale();

/// Of the present theme, in the form that drawing takes.
ImVec4 color_of(ColorRole role, float alpha = 1.0f);
ImU32 shade_of(ColorRole role, float alpha = 1.0f);

}  // namespace shvr::ui
