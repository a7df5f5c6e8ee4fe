#pragma once
// Names that dialogs suggest for new files, and sizes of files in words. Pure; any thread.

#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns a file's path without its extensions: "/scans/leaf" for "/scans/leaf.nii.gz" and "/scans/leaf.session.json".
std::filesystem::path stem_of(std::filesystem::path path);
/// Returns the beginning of the names of files that belong to the open document: "/scans/leaf", in the folder of its
/// session or of its project. Empty while no document is open.
std::filesystem::path base_of(const Model& model);
/// Returns the path that a typed name means: relative names lie in `folder`, and "~" is the home folder.
std::filesystem::path placed(const std::string& typed, const std::filesystem::path& folder);
/// The same for a file or folder that is to be made: blanks before and behind the name are left out.
std::filesystem::path placed_new(const std::string& typed, const std::filesystem::path& folder);

/// Returns "1.4 GB": 1000 bytes are 1 kB.
std::string bytes_in_words(double bytes);

}  // namespace shvr::ui
