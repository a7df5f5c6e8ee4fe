#pragma once
// Locks of folders, held by one process at a time and released if it dies.

#include <filesystem>
#include <optional>

#include "engine/base/file.h"

namespace shvr {

/// Name of the file in a folder that is locked instead of the folder where only files can be locked, as on NFS. Keep it
/// when emptying a locked folder, and remove it once the lock is released.
inline constexpr const char* FOLDER_LOCK = ".shvr-lock";

/// Locks an existing folder. Null, with errno EWOULDBLOCK, if another process has locked it; null, with another errno,
/// if it cannot be opened. On file systems without locks, succeeds always if `allowed`, and otherwise never.
enum class WithoutLocks { allowed, refused };
std::optional<FileDescriptor> lock_folder(const std::filesystem::path& folder, WithoutLocks without_locks);

/// Whether the folder is still the one that was locked: false if it was moved, removed or replaced.
bool is_lock_of(const FileDescriptor& lock, const std::filesystem::path& folder);

/// Removes a locked folder, as far as possible, and releases the lock.
void remove_locked_folder(const std::filesystem::path& folder, std::optional<FileDescriptor>& lock);

}  // namespace shvr
