#pragma once
// Palette entries for items of the scan and of the preferences: recent files, preferences, panels, operations on
// groups, brushes, groups, views, nodes, transfer functions, looks. Pure; main thread only.

#include "engine/workbench/bindings/palette.h"

namespace shvr::ui {

/// Adds the entries whose names and descriptions contain all words of the text, at most twenty of each kind.
void add_listed(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text);

}  // namespace shvr::ui
