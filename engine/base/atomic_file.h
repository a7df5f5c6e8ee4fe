#pragma once
// Saves a file such that either the old or the new content is there at any moment: a temporary file in the same folder
// is written, synced and renamed over the old one, then the folder is synced. Any thread may call it.

#include <cstddef>
#include <filesystem>
#include <span>

namespace shvr {

/// Makes `path` a file with exactly this content. An existing file keeps its permissions; a symbolic link is replaced,
/// not followed; anything but a regular file (a folder, /dev/null) is refused. Fails with the path and the system's
/// reason; the temporary file is then removed and the old file untouched, byte for byte. The one exception, which the
/// message states: the folder could not be synced after the rename.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
