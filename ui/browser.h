#pragma once
// Starts the desktop's browser. Main thread.

#include <filesystem>

namespace shvr::ui {

/// Opens a local page with xdg-open; the browser may outlive this program. Returns false if xdg-open is missing; does
/// not detect whether the browser itself fails.
bool show_in_browser(const std::filesystem::path& page);

}  // namespace shvr::ui
