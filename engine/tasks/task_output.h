#pragma once
// Names of files that a task is to write, checked before any work. Any thread.

#include <filesystem>
#include <string>
#include <vector>

namespace shvr {

/// A name with none of `extensions` is wrong usage (UsageError), in which the option is called `option`; a folder that
/// is missing or not writable is an error. An empty `path` means that nothing is to be written and passes.
void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions);
/// The same for a file with any extension.
void check_output_place(const std::filesystem::path& path);
/// Fails where writing `output` would replace `input`, which is read: a file, or one in a folder of slices.
void check_output_is_not(const std::filesystem::path& input, const std::filesystem::path& output);
/// A folder that files are to be written into, or an image that is one; it and folders above it need not exist yet.
void check_output_folder(const std::filesystem::path& path);

}  // namespace shvr
