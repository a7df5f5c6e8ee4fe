#pragma once
// The texts of the last drawn frame, recovered from its triangles: readable text and its position.
// Tests find menus and buttons by their words, and detect words that are cut off or overlap.
// Main thread, after Window::present and before the next begin_ui.

#include <string>
#include <vector>

#include <glm/glm.hpp>

struct ImDrawData;
struct ImFont;

namespace shvr::ui {

/// Consecutive characters on one line, including spaces, spaced as the font places them.
struct ScreenText {
    std::string text;            ///< UTF-8
    std::string window;          ///< Dear ImGui's name of the window that contains it
    glm::vec2 begin{0}, end{0};  ///< box of the visible pixels, in pixels of the frame buffer
    bool is_cut = false;         ///< cut at its left or right end, within a character
    bool is_scrolled = false;    ///< partly above or below the visible part of its window
};

/// Returns texts in the order of drawing: later ones lie over earlier ones. Omits invisible characters.
std::vector<ScreenText> screen_texts(const ImDrawData& drawn, const ImFont& font);
/// State of a frame, for tests that wait for it.
struct FrameState {
    uint64_t number = 0;
    bool is_sharp = false;  ///< nothing is left to be refined
    bool is_kept = false;   ///< the journal holds the view, the probe and all settings
};

/// Returns {"frame": 7, "sharp": true, "kept": true,
///          "texts": [{"text", "window", "box": [x0, y0, x1, y1], "cut", "scrolled"}]}
std::string json_of(const std::vector<ScreenText>& texts, const FrameState& frame);

}  // namespace shvr::ui
