#pragma once
// The last line of a trace: the number of lines before it, and a hash of their bytes, which reveals a file that was
// truncated or changed in transit. It finds accidents and edits; it is not a signature. Any thread.

#include <string>
#include <string_view>

namespace shvr {

/// Returns the last line. `text`: all preceding lines, each with its line break.
std::string trace_end(std::string_view text);
/// Returns the lines before the end line. Fails if there is no end line, or if it does not match them.
std::string_view without_trace_end(std::string_view text, const std::string& origin);

}  // namespace shvr
