#pragma once
// What a text that a person types can mean: shortcuts by words, an action as text ("look_from camera=top"), a setting
// ("light.ambient=0.4"), or the beginning of one of these. Pure; the main thread.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/workbench/bindings/shortcuts.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct PaletteEntry {
    std::string name, group;
    std::string keys{};              ///< in words
    std::string why_not{};           ///< it cannot be done now; empty: it can
    std::optional<Action> action{};  ///< what it does
    std::string completion{};        ///< instead of an action: the text to go on with
};

/// The most fitting first: the action or setting that is typed, shortcuts, then what the text can be completed to.
std::vector<PaletteEntry> palette_entries(const Model& model, std::string_view text);

/// Whether each word of `text` occurs in `where`, in any case of letters.
bool has_words(std::string_view where, std::string_view text);

}  // namespace shvr::ui
