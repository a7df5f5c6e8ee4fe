#pragma once
// Whether work can be saved at a path at all, found out before anything is to be saved there. Any thread; may wait for
// a disk.

#include <filesystem>
#include <string>

namespace shvr::ui {

/// Returns why no file can be written into the folder of `file`, which need not exist yet: a sentence that names the
/// folder. Empty: one can, as far as is known. Leaves nothing behind.
std::string why_not_savable(const std::filesystem::path& file);

}  // namespace shvr::ui
