#pragma once
// Interprets text typed into the palette: shortcuts, panels, settings, recent files, groups, views, nodes and transfer
// functions by words, an action as text ("look_from camera=top"), a setting with its value ("light.ambient=0.4" or
// "ambient 0.4"), or the beginning of one of these. Pure; main thread only.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/workbench/bindings/shortcuts.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct PaletteEntry {
    std::string name, group;
    std::string keys{};              ///< keys as displayed
    std::string why_not{};           ///< reason why the entry is unavailable now; empty if it is available
    std::optional<Action> action{};  ///< action that the entry performs
    std::string completion{};        ///< text to replace the input with; an entry that has a completion has no action
    std::optional<Action> then{};    ///< performed after `action`
    std::string bound_as{};          ///< what a key is bound to (BindKeys); empty: the entry cannot have a key
};

/// Returns entries, best match first: a typed action or setting, shortcuts and panels, settings with a typed value,
/// items of the scan, then possible completions of the text. For an empty text, returns all shortcuts.
std::vector<PaletteEntry> palette_entries(const Model& model, std::string_view text);

/// Returns whether each word of `text` occurs in `where`, ignoring case.
bool has_words(std::string_view where, std::string_view text);

}  // namespace shvr::ui
