#pragma once
// The tools of the mouse in words: name, key, and what buttons and wheel do now. Pure; any thread.

#include <span>
#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct ToolRow {
    Tool tool = Tool::turn;
    const char* name = "";      ///< "Paint"
    const char* shortcut = "";  ///< id of the one that takes it
    const char* hint = "";      ///< what a click does, in sentences
    const char* left = "";      ///< what the left button does, in a few words
    const char* right = "";
};
/// In the order of the tool bar.
std::span<const ToolRow> tool_rows();
const ToolRow& row_of(Tool tool);

/// What is said when it is taken.
std::string sentence_of(Tool tool);
/// What the mouse does over a pane of that kind, in one line: "left: paint, right or middle: turn, wheel: zoom".
std::string mouse_in_words(Tool tool, Pane::Kind over = Pane::Kind::main);

}  // namespace shvr::ui
