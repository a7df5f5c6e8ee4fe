#pragma once
// Locates the data files that ship with the program, and the user's folders for configuration and caches (XDG Base
// Directory Specification). Any thread.

#include <filesystem>
#include <string>

namespace shvr {

/// Returns the first existing folder `name` in $SHVR_ASSETS, the installed tree or the source tree; empty: none exists.
std::filesystem::path asset_folder(const std::string& name);

/// Returns the path of the user manual's first page (HTML) in the installed tree, or else in the build tree. If neither
/// has the page, returns the path where an installation would have it.
std::filesystem::path manual_page();

/// Folder of preferences, may be missing: $XDG_CONFIG_HOME/shvr or ~/.config/shvr. Empty if that and $HOME are unset.
std::filesystem::path config_folder();
/// Folder of recomputable files: $XDG_CACHE_HOME/shvr or ~/.cache/shvr. Empty if that variable and $HOME are unset.
std::filesystem::path cache_folder();

}  // namespace shvr
