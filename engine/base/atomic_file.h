#pragma once
// Saving without a moment at which the old content is gone and the new one is not there yet: a temporary file in the
// same folder is written, synced and renamed over the old one, then the folder is synced. Any thread may call it.

#include <cstddef>
#include <filesystem>
#include <span>

namespace shvr {

/// Makes `path` a file with exactly this content. A file that was there keeps its permissions; a symbolic link is
/// replaced, not followed; what is no regular file (a folder, /dev/null) is refused. Fails with the path and the
/// system's reason; then the temporary file is gone and the old file untouched, byte for byte. The one exception is
/// said in its message: the folder could not be synced after the rename.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
