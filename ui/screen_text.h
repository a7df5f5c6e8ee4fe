#pragma once
// The texts of the frame that was drawn last, read back from its triangles: what a person can read on the screen, and
// where. Tests find menus and buttons by their words, and see whether words are cut off or lie over one another.
// Main thread, after Window::present and before the next begin_ui.

#include <string>
#include <vector>

#include <glm/glm.hpp>

struct ImDrawData;
struct ImFont;

namespace shvr::ui {

/// Characters on one line that follow one another as the font sets them, spaces included.
struct ScreenText {
    std::string text;            ///< UTF-8
    std::string window;          ///< Dear ImGui's name of the window that it is in
    glm::vec2 begin{0}, end{0};  ///< box of the visible ink, in pixels of the frame buffer
    bool is_cut = false;         ///< at its left or right end, within a character
    bool is_scrolled = false;    ///< partly above or below what its window shows
};

/// In the order of drawing: later ones lie over earlier ones. Characters wholly out of sight are left out.
std::vector<ScreenText> screen_texts(const ImDrawData& drawn, const ImFont& font);
/// {"frame": 7, "sharp": true, "texts": [{"text", "window", "box": [x0, y0, x1, y1], "cut", "scrolled"}]}
std::string json_of(const std::vector<ScreenText>& texts, uint64_t frame, bool is_sharp);

}  // namespace shvr::ui
