#pragma once
// Interprets text typed into the palette: shortcuts, operations, panels, settings, preferences, recent files, groups,
// brushes, views, nodes and transfer functions by words, in any case; a value behind words ("ambient 0.4"); and for
// those who write scripts, an action as text ("look_from camera=top"), a setting as key and value
// ("light.ambient=0.4"), or the beginning of one of these. Pure; main thread only.

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

/// Returns entries, best match first: shortcuts, settings and preferences with a typed value, lists (palette_lists.h),
/// settings, then an action whose id was typed. If nothing has the words, the settings that refuse the value, and
/// possible completions of the text. For a text with "=", only the action or setting. For an empty text, all shortcuts.
std::vector<PaletteEntry> palette_entries(const Model& model, std::string_view text);

/// Returns whether each word of `text` occurs in `where`, ignoring case.
bool has_words(std::string_view where, std::string_view text);

}  // namespace shvr::ui
