#pragma once
// Locates the data files that the program ships with, and the user's folders for its files (XDG Base Directory
// Specification). Any thread.

#include <filesystem>
#include <string>

namespace shvr {

/// The folder `name` in $SHVR_ASSETS, or else in the installed or built tree. Empty if there is none.
std::filesystem::path asset_folder(const std::string& name);

/// First page of the user manual, in HTML: that of the installed or the built tree, or, where neither has one, its path
/// in an installed tree.
std::filesystem::path manual_page();

/// $XDG_CONFIG_HOME/shvr or ~/.config/shvr: preferences. Empty if the environment gives neither; may not exist.
std::filesystem::path config_folder();
/// $XDG_CACHE_HOME/shvr or ~/.cache/shvr: files that can be made again. Empty if the environment gives neither.
std::filesystem::path cache_folder();

}  // namespace shvr
