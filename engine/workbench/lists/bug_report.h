#pragma once
// Messages as text for the user, and as a report to paste into a bug report. Pure, except for the time zone of
// the clock; the main thread.

#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns "error" and the like; "" for Weight::done.
const char* word_of(Weight weight);
/// Returns "14:03:59", in the local time zone.
std::string time_in_words(const Message& message);
/// Returns "1 error, 2 warnings" for unread messages; empty if there are none.
std::string unread_in_words(const MessageLog& messages);
/// Returns program, device, session, the last actions and the last messages, as Markdown.
std::string bug_report(const Model& model);

}  // namespace shvr::ui
