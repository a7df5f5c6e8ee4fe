#pragma once
// Texts of messages for the user, and a report to paste into an issue. Pure, except for the clock's time zone; main
// thread only.

#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the word of a weight, such as "error"; "" for Weight::done.
const char* word_of(Weight weight);
/// Returns "14:03:59", in the local time zone.
std::string time_in_words(const Message& message);
/// Returns "1 error, 2 warnings" for unread messages; empty if there are none.
std::string unread_in_words(const MessageLog& messages);
/// Returns the program, device, session, last actions and last messages, as Markdown.
std::string bug_report(const Model& model);

}  // namespace shvr::ui
