#pragma once
// The clipboard for pictures, through xclip (X11) or wl-copy (Wayland), since GLFW copies text only. Any thread.

#include <filesystem>
#include <string>

namespace shvr {

/// The program that copies pictures on this display.
struct ClipboardProgram {
    std::string name;     ///< "xclip"
    std::string package;  ///< the package that brings it
    bool is_installed = false;
};
ClipboardProgram clipboard_program();

/// Puts a PNG file into the clipboard, which keeps a copy of its own. Fails if the program is missing or fails.
void copy_png(const std::filesystem::path& file);
/// Returns a new path for a picture on its way to the clipboard. The caller removes the file.
std::filesystem::path path_for_clipboard();

}  // namespace shvr
