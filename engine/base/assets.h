#pragma once
// Where the files lie that the program ships beside its code. Any thread.

#include <filesystem>
#include <string>

namespace shvr {

/// The folder of that name in $SHVR_ASSETS, or in what lies where the program was installed or built. Empty where there
/// is none.
std::filesystem::path asset_folder(const std::string& name);

}  // namespace shvr
