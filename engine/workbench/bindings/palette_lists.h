#pragma once
// Entries of the palette for what the scan and the preferences list: recent files, panels, groups, views, nodes,
// transfer functions. Pure; main thread only.

#include "engine/workbench/bindings/palette.h"

namespace shvr::ui {

/// Adds those that have all words of the text, at most twenty of a kind.
void add_listed(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text);

}  // namespace shvr::ui
