#pragma once
// Checks the names of files that a task is to write, before any work. Any thread.

#include <filesystem>
#include <string>
#include <vector>

namespace shvr {

/// Throws UsageError, which names the option as `option`, if the name has none of `extensions`. Fails if the folder is
/// missing or not writable. Accepts an empty `path`, which means that nothing is to be written.
void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions);
/// Checks the folder like check_output, for a file with any extension.
void check_output_place(const std::filesystem::path& path);
/// Returns the path to write for an output that a user names: for a symbolic link its target, so that the link stays.
/// Removes temporary files that killed programs have left next to it.
std::filesystem::path written_path(const std::filesystem::path& path);
/// Fails if writing `output` would replace or extend `input`, which the task reads: a file, or a folder of slices, in
/// which a new picture would be read as a slice.
void check_output_is_not(const std::filesystem::path& input, const std::filesystem::path& output);
/// Returns the file that a command reads for an input: the session in a project's folder, or else the input itself.
/// Pictures in that folder are no slices of the project.
std::filesystem::path file_of_input(const std::filesystem::path& input);
/// Checks that a folder for files, or an image that is a folder, can be written; it and its parents may not exist yet.
void check_output_folder(const std::filesystem::path& path);

}  // namespace shvr
