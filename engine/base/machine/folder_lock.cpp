#include "engine/base/machine/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace shvr {

namespace fs = std::filesystem;

bool is_lock_of(const FileDescriptor& lock, const fs::path& folder)
{
    struct stat held {
    }, found{};
    if (::fstat(lock.number(), &held) != 0) return false;
    const fs::path path = S_ISDIR(held.st_mode) ? folder : folder / FOLDER_LOCK;
    return ::stat(path.c_str(), &found) == 0 && held.st_dev == found.st_dev && held.st_ino == found.st_ino;
}

namespace {

/// Returns the descriptor's number; negative if the file can neither be opened nor made.
int open_lock_file(const fs::path& folder)
{
    return ::open((folder / FOLDER_LOCK).c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
}

}  // namespace

std::optional<FileDescriptor> lock_folder(const fs::path& folder, WithoutLocks without_locks)
{
    constexpr int TRIES = 3;  // file systems with changing inode numbers always seem to have moved the folder
    for (int tries = 1;; ++tries) {
        FileDescriptor whole(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        if (!whole) return std::nullopt;
        bool is_locked = ::flock(whole.number(), LOCK_EX | LOCK_NB) == 0;
        if (!is_locked && errno == EWOULDBLOCK) return std::nullopt;
        // NFS locks neither folders nor what is opened for reading alone. A folder that cannot be written is refused
        // with the reason later.
        FileDescriptor file(is_locked ? -1 : open_lock_file(folder));
        if (file) is_locked = ::flock(file.number(), LOCK_EX | LOCK_NB) == 0;
        if (!is_locked && (errno == EWOULDBLOCK || without_locks == WithoutLocks::refused)) return std::nullopt;
        FileDescriptor& lock = file ? file : whole;
        // The folder may have been moved after it was opened and before it was locked.
        if (is_lock_of(lock, folder) || tries == TRIES) return std::move(lock);
    }
}

void remove_locked_folder(const fs::path& folder, std::optional<FileDescriptor>& lock)
{
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
        if (entry.path().filename() != FOLDER_LOCK) fs::remove_all(entry.path(), ignored);
    ::rmdir(folder.c_str());  // not if the file of the lock is in it, which NFS cannot remove while it is open
    lock.reset();
    if (fs::remove(folder / FOLDER_LOCK, ignored)) ::rmdir(folder.c_str());
}

}  // namespace shvr
