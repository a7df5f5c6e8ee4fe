#pragma once
// The font files of this machine. Any thread.

#include <string>

namespace shvr::ui {

/// Returns the file of the interface's font; empty if this machine has none of those known.
std::string interface_font();

}  // namespace shvr::ui
