#pragma once
// The content of JOURNAL.lock, which describes its holder: a line for each part. Any thread.

#include <ctime>

#include "engine/annotation/writers/hold.h"

namespace shvr {

/// "2026-11-22 13:20:05", in local time
std::string time_in_words(std::time_t time);

std::string to_text(const Holder& holder);
/// The file is untrusted: unknown lines are skipped, long parts
/// are truncated, and unprintable characters are replaced.
Holder parse_holder(std::string_view text);

}  // namespace shvr
