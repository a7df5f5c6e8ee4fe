#pragma once
// The last line of a trace: how many lines come before it, and a hash of their bytes, so that a file that was cut off
// or changed on its way is told from one that is whole. It finds accidents and edits; it is no signature. Any thread.

#include <string>
#include <string_view>

namespace shvr {

/// `text`: all lines before it, each with its line break.
std::string trace_end(std::string_view text);
/// The lines before the end line. Fails where there is none, or it is of other lines.
std::string_view without_trace_end(std::string_view text, const std::string& origin);

}  // namespace shvr
