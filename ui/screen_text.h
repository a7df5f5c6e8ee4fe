#pragma once
// The texts of the last drawn frame, recovered from its triangles, with their positions. Tests use them to find menus
// and buttons by their words, and to detect words that are cut off or overlap. Main thread, after Window::present and
// before the next begin_ui.

#include <string>
#include <vector>

#include <glm/glm.hpp>

struct ImDrawData;
struct ImFontAtlas;

namespace shvr::ui {

/// Consecutive characters of one line, including spaces, as far apart as the font places them.
struct ScreenText {
    std::string text;            ///< UTF-8
    std::string window;          ///< Dear ImGui's name of the window that contains the text
    glm::vec2 begin{0}, end{0};  ///< box of the visible pixels, in pixels of the frame buffer
    bool is_cut = false;         ///< the clipping at the left or right end cuts a character
    bool is_scrolled = false;    ///< partly above or below the visible part of its window
};

/// Returns the texts in the order of drawing: later ones cover earlier ones. Omits invisible characters, and rims: a
/// text that is drawn several times around one place is one text.
std::vector<ScreenText> screen_texts(const ImDrawData& drawn, const ImFontAtlas& fonts);
/// State of a frame, for tests that wait until it is reached.
struct FrameState {
    uint64_t number = 0;
    bool is_sharp = false;  ///< nothing is left to be refined
    bool is_kept = false;   ///< the journal holds the view, the probe and all settings
};

/// Returns {"frame": 7, "sharp": true, "kept": true,
///          "texts": [{"text", "window", "box": [x0, y0, x1, y1], "cut", "scrolled"}]}
std::string json_of(const std::vector<ScreenText>& texts, const FrameState& frame);

}  // namespace shvr::ui
