#pragma once
// Starts the desktop's browser. Main thread.

#include <filesystem>

namespace shvr::ui {

/// Opens a local page by xdg-open, which outlives this program. Returns false if there is no xdg-open; failures of the
/// browser itself are not noticed.
bool show_in_browser(const std::filesystem::path& page);

}  // namespace shvr::ui
