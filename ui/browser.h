#pragma once
// Starts the desktop's browser. Main thread.

#include <filesystem>

namespace shvr::ui {

/// Opens a local page with xdg-open; the browser may outlive this program. Returns false if xdg-open is missing;
/// failures of the browser itself are not detected.
bool show_in_browser(const std::filesystem::path& page);

}  // namespace shvr::ui
