#pragma once
// The content of JOURNAL.lock, which describes the holder: one line per property. Any thread.

#include <ctime>

#include "engine/annotation/writers/hold.h"

namespace shvr {

/// "2026-11-22 13:20:05", in local time
std::string time_in_words(std::time_t time);

std::string to_text(const Holder& holder);
/// Reads untrusted text: skips unknown lines, truncates long values, and replaces unprintable
/// characters.
Holder parse_holder(std::string_view text);

}  // namespace shvr
