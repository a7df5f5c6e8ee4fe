#pragma once
// Locates the data files that the program ships with. Any thread.

#include <filesystem>
#include <string>

namespace shvr {

/// The folder `name` in $SHVR_ASSETS, or else in the installed or built tree. Empty if there is none.
std::filesystem::path asset_folder(const std::string& name);

}  // namespace shvr
