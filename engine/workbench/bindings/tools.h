#pragma once
// Descriptions of the mouse tools: name, key, and the effects of buttons and wheel. Pure; any thread.

#include <span>
#include <string>

#include "engine/workbench/models/model.h"
#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

struct ToolRow {
    Tool tool = Tool::turn;
    const char* name = "";      ///< "Paint"
    const char* shortcut = "";  ///< id of the shortcut that selects the tool
    const char* hint = "";      ///< effect of a click, in sentences
    const char* left = "";      ///< effect of the left mouse button, in a few words
    const char* right = "";
};
/// Returns all tools, in the order of the tool bar.
std::span<const ToolRow> tool_rows();
const ToolRow& row_of(Tool tool);

/// Returns the message that is shown when the user selects the tool.
std::string sentence_of(Tool tool);
/// Describes buttons and wheel over a pane of kind `over`, with a set of keys: "left: paint, right or middle: turn,
/// wheel: zoom".
std::string mouse_in_words(Tool tool, Pane::Kind over = Pane::Kind::main, KeySet set = KeySet::modern);

}  // namespace shvr::ui
