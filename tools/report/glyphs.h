#pragma once
// Bitmap letters of 5 x 7 pixels, for plots drawn as pixels: ASCII from space to '~'. Pure; any thread.

namespace shvr::report {

inline constexpr int GLYPH_COLUMNS = 5, GLYPH_ROWS = 7;
/// Returns whether the pixel is ink. Row 0 is the top row, and row GLYPH_ROWS is the row below the base line. Non-ASCII
/// characters are blank.
bool glyph_has(char letter, int column, int row);

}  // namespace shvr::report
