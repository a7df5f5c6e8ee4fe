#pragma once
// The registry of actions: the stable id, name, group and meaning of each, its arguments as JSON and as text, and the
// reason why it is unavailable now. Keys, menus, palette, scripts and logs all refer to ids. Pure; any thread.
//
// {"op":"orbit","right_degrees":3} a line of a script or of a log
//   orbit right_degrees=3                the same as text

#include <span>
#include <string>
#include <string_view>

#include "engine/base/json.h"
#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the rows of all actions; the position of a row is the index of its action.
std::span<const ActionRow> action_rows();
const ActionRow& row_of(const Action& action);

/// Returns the action as a line of JSON, from which `read_action` makes the same action again.
std::string line_of(const Action& action);
/// Adds the time of day as the key "time" (engine/annotation/script/log_time.h), which `read_action` ignores.
std::string with_present_time(const std::string& line);
/// Fails for unknown ids, keys and values; the message names the expected ones.
Action read_action(const JsonNode& line);
/// `origin` names the text in messages.
Action read_action(std::string_view line, const std::string& origin);
/// Returns the action as text; values that contain spaces are written as JSON.
std::string text_of(const Action& action);
Action action_of_text(const std::string& text);

/// Returns why the action would do nothing or be refused: "nothing is open", "no node is selected"; empty if it is
/// available. An available action may still fail for reasons that only the device or a file reveals.
std::string why_not(const Model& model, const Action& action);
/// Returns whether the action is unavailable only because strokes that the user has ended are not fully painted yet.
bool waits_for_strokes(const Model& model, const Action& action);

}  // namespace shvr::ui
