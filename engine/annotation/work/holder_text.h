#pragma once
// What JOURNAL.lock says of who holds it: a line for each part. Any thread.

#include "engine/annotation/work/hold.h"

namespace shvr {

std::string to_text(const Holder& holder);
/// Anything may stand there: lines that are unknown are passed over, long parts are cut, and what a terminal cannot
/// show is replaced.
Holder parse_holder(std::string_view text);

}  // namespace shvr
