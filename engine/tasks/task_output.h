#pragma once
// Checks the names of files that a task is to write, before any work. Any thread.

#include <filesystem>
#include <string>
#include <vector>

namespace shvr {

/// Throws UsageError, calling the option `option`, if the name has none of `extensions`, and fails if its folder is
/// missing or not writable. An empty `path` means that nothing is to be written and passes.
void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions);
/// Likewise for a file with any extension.
void check_output_place(const std::filesystem::path& path);
/// The file to be written for an output that a user names: a symbolic link stays, and its target is written. Removes
/// temporary files that killed programs have left next to it.
std::filesystem::path written_path(const std::filesystem::path& path);
/// Fails if writing `output` would replace `input`, which is read, or add to it: a file, or one in a folder of slices,
/// in which a new picture would be read as a slice.
void check_output_is_not(const std::filesystem::path& input, const std::filesystem::path& output);
/// Checks a folder to write files into, or an image that is a folder; it and its parents need not exist yet.
void check_output_folder(const std::filesystem::path& path);

}  // namespace shvr
