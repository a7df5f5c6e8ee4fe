#pragma once
// Colours, shapes and fonts of all panels. Main thread, between frames unless stated otherwise.

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
    double font_pixels = 14.0;  ///< font size at a scale of 1
    double scale = 1.0;         ///< scale of the whole interface
    bool operator==(const Appearance&) const = default;
};

/// Sets the style and rebuilds the font atlas. Fonts are uploaded when the back end is attached, and later by
/// Window::renew_fonts.
void set_style(const Appearance& appearance);

/// Fills the font atlas (fonts.cpp).
void load_fonts(double pixels);

/// The panels' text; headings, which are bold; and small texts, for what is read once. The latter two have only the
/// characters of English.
enum class TextRole { body, heading, small };
/// Texts that are drawn during its life are in the font of their role.
class TextIn {
public:
    explicit TextIn(TextRole role);
    ~TextIn();
    TextIn(const TextIn&) = delete;
    TextIn& operator=(const TextIn&) = delete;
};

/// Renders texts in the interface's fonts, `pixels` high, for picture files (figure.h).
std::vector<TextImage> draw_texts(std::span<const std::string> texts, double pixels);

/// Requests the characters of user text: names, paths, messages. They can be drawn from the next frame on, if this
/// machine has a font with them. Cheap; any time on the main thread.
void want_glyphs(std::string_view text);
/// Requests the characters typed since the last frame.
void want_typed_glyphs();
/// Returns whether the atlas lacks requested characters or pictures (ui/thumbnails): then call set_style.
bool fonts_are_stale();

/// Returns a colour of the present theme, in the format of Dear ImGui.
ImVec4 color_of(ColorRole role, float alpha = 1.0f);
ImU32 shade_of(ColorRole role, float alpha = 1.0f);

}  // namespace shvr::ui
