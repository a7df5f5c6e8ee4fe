#pragma once
// The content of JOURNAL.lock, which describes its holder: a line for each part. Any thread.

#include "engine/annotation/work/hold.h"

namespace shvr {

std::string to_text(const Holder& holder);
/// The file is untrusted: unknown lines are skipped, long parts
/// are truncated, and unprintable characters are replaced.
Holder parse_holder(std::string_view text);

}  // namespace shvr
