#pragma once
// Letters of 5 x 7 pixels, for plots as pixels: ASCII from space to '~'. Pure; any thread.

namespace shvr::report {

inline constexpr int GLYPH_COLUMNS = 5, GLYPH_ROWS = 7;
/// Whether the pixel is ink; row 0 is the top, row GLYPH_ROWS the one below the base line. Non-ASCII characters are
/// blank.
bool glyph_has(char letter, int column, int row);

}  // namespace shvr::report
