#pragma once
// Saves a file so that readers find either the old or the new content at any moment: writes and syncs a temporary file
// in the same folder, renames it over the old file, then syncs the folder. Any thread may call it.

#include <cstddef>
#include <filesystem>
#include <span>

namespace shvr {

/// Replaces the content of the file `path`, or creates the file. An existing file keeps its permissions; a symbolic
/// link is replaced, not followed; anything but a regular file (a folder, /dev/null) is refused. On failure, the
/// message states path and system reason, the temporary file is removed, and the old file stays unchanged. One
/// exception, stated in the message: the new file is in place, but syncing its folder failed.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
