#pragma once
// Saves a file so that either the old or the new content is present at any moment: writes and syncs a temporary file in
// the same folder, renames it over the old file, then syncs the folder. Any thread may call it.

#include <cstddef>
#include <filesystem>
#include <span>

namespace shvr {

/// Makes `path` a file with exactly this content. An existing file keeps its permissions; a symbolic link is replaced,
/// not followed; anything but a regular file (a folder, /dev/null) is refused. A failure states the path and the
/// system's reason, removes the temporary file and leaves the old file untouched, byte for byte. The one exception,
/// which the message states: the folder could not be synced after the rename.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
