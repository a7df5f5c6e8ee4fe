#pragma once
// Checks the names of files that a task is to write, before any work. Any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

/// Throws UsageError, which names the option as `option`, if the name has none of `extensions`. Fails if the folder is
/// missing or not writable, or the name too long. Accepts an empty `path`, which means that the task writes no file.
void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions);
/// Checks the folder and the length of the name like check_output, for a file with any extension.
void check_output_place(const std::filesystem::path& path);
/// Returns the path to write for an output that a user names: the target of a symbolic link, so that the link stays.
/// Removes temporary files next to it that killed programs have left.
std::filesystem::path written_path(const std::filesystem::path& path);
/// Fails if writing `output` would replace or extend `input`, which the task reads. `input` is a file or a folder of
/// slices; a new picture in such a folder would later be read as a slice.
void check_output_is_not(const std::filesystem::path& input, const std::filesystem::path& output);
/// Returns the file that a command reads for an input: the session in a project's folder, or else the input itself. For
/// a project this avoids reading pictures in its folder as slices.
std::filesystem::path file_of_input(const std::filesystem::path& input);
/// Checks that a folder for files, or an image that is a folder, can be written, even if parents do not exist yet.
void check_output_folder(const std::filesystem::path& path);
/// Checks that a folder of this name can be made in the folder around it, which must exist. Accepts a path that is
/// taken.
void check_new_folder(const std::filesystem::path& path);
/// Returns the bytes that are free where a file or a folder is to be made; it and the folders around it need not exist
/// yet. Null: unknown.
std::optional<double> free_space(const std::filesystem::path& path);

}  // namespace shvr
