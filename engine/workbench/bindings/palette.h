#pragma once
// Interprets text typed into the palette: shortcuts by words, an action as text ("look_from camera=top"), a setting
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
    std::string why_not{};           ///< reason why the entry is unavailable now; empty: available
    std::optional<Action> action{};  ///< action that the entry performs
    std::string completion{};        ///< text that continues the input; if set, the entry has no action
};

/// Returns entries, best match first: a typed action or setting, shortcuts, then possible completions of the text.
std::vector<PaletteEntry> palette_entries(const Model& model, std::string_view text);

/// Returns whether each word of `text` occurs in `where`, ignoring case.
bool has_words(std::string_view where, std::string_view text);

}  // namespace shvr::ui
