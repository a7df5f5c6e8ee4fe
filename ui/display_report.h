#pragma once
// Describes the window system, for a report on the machine. Main thread, while no window is open.

#include <string>
#include <vector>

namespace shvr::ui {

struct DisplayReport {
    std::string why_no_window{};         ///< empty if a window can be opened
    std::vector<std::string> screens{};  ///< name and size of each
    std::string font{};                  ///< file of the interface's font; empty: a small built-in one is used
};
/// Connects to the display, collects the report and disconnects. Opens no window.
DisplayReport survey_display();

}  // namespace shvr::ui
