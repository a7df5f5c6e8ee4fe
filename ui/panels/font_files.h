#pragma once
// Finds the font files of this machine. Any thread.

#include <string>

namespace shvr::ui {

/// Returns the file of the interface's font; empty if none of the known fonts is installed.
std::string interface_font();

}  // namespace shvr::ui
