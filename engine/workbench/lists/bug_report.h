#pragma once
// Texts about messages to the user, and a report to paste into an issue. Pure functions, except that times are in the
// system's time zone; main thread only.

#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the word for a weight, such as "error"; an empty text for Weight::done.
const char* word_of(Weight weight);
/// Returns "14:03:59", in the local time zone.
std::string time_in_words(const Message& message);
/// Returns how many messages are unread, as "1 error, 2 warnings"; empty if none is.
std::string unread_in_words(const MessageLog& messages);
/// Returns a report in Markdown: program, device, session, last actions and last messages.
std::string bug_report(const Model& model);

}  // namespace shvr::ui
