#pragma once
// The registry of actions: for each its stable id, name, group and meaning, its arguments as JSON and as text, and why
// it cannot be applied just now. Keys, menus, palette, scripts and logs all go by ids. Pure; any thread.
//
//   {"op":"orbit","right_degrees":3}     a line of a script or of a log
//   orbit right_degrees=3                the same as text

#include <span>
#include <string>
#include <string_view>

#include "engine/base/json.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// In the order of the alternatives of Action.
std::span<const ActionRow> action_rows();
const ActionRow& row_of(const Action& action);

/// A line of JSON that `read_action` reads as the same action.
std::string line_of(const Action& action);
/// Fails at ids, keys and values that it does not know, naming what was expected.
Action read_action(const JsonNode& line);
/// `origin` names the text in messages.
Action read_action(std::string_view line, const std::string& origin);
/// As text; values that hold spaces are JSON texts.
std::string text_of(const Action& action);
Action action_of_text(const std::string& text);

/// Why it would do nothing or be refused: "nothing is open", "no node is selected"; empty where nothing speaks against
/// it. Applying may still fail for reasons that only the device or a file knows.
std::string why_not(const Model& model, const Action& action);
/// Whether it only has to wait for strokes that have ended and are being painted.
bool waits_for_strokes(const Model& model, const Action& action);

}  // namespace shvr::ui
