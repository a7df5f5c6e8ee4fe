#pragma once
// What was said, in words for people, and as a report to paste where a bug is told of. Pure, but for the time zone of
// the clock; the main thread.

#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// "error"; of what went as it should, "".
const char* word_of(Weight weight);
/// "14:03:59", in the person's time zone.
std::string time_in_words(const Message& message);
/// "1 error, 2 warnings" of those that nobody has looked at; empty where there are none.
std::string unread_in_words(const MessageLog& messages);
/// Program, device, session, the last actions and the last messages, as Markdown.
std::string bug_report(const Model& model);

}  // namespace shvr::ui
