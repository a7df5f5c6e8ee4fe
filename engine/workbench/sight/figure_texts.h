#pragma once
// Fits texts of a figure into the room that is left for them: line breaks, wrapping and shortening. Pure; any thread,
// except for the drawer of texts.

#include <span>
#include <string>
#include <vector>

#include "engine/workbench/sight/figure.h"

namespace shvr::ui {

/// Returns the width of each text in pixels, if its line is `height` pixels high.
std::vector<double> widths_of(std::span<const std::string> texts, double height, const TextDrawer& draw_texts);

/// Returns the text if it is at most `width` pixels wide; otherwise its longest beginning that is, followed by "...".
/// Returns an empty text if not even one character fits. Breaks between characters of UTF-8 only.
std::string shortened(const std::string& text, double width, double height, const TextDrawer& draw_texts);

/// The lines of a text, and whether words of it are missing.
struct FittedLines {
    std::vector<std::string> lines;
    bool is_shortened = false;
};
/// Splits a text at its line ends, and lines that are too wide at spaces, into at most `most` lines. Shortens words
/// that are too wide, and the last line if more would follow. Without room, there are no lines.
FittedLines lines_of(const std::string& text, double width, double height, size_t most, const TextDrawer& draw_texts);

}  // namespace shvr::ui
