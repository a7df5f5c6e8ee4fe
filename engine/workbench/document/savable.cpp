#include "engine/workbench/document/savable.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr::ui {

namespace {

constexpr uint64_t MIN_FREE_BYTES = uint64_t{1} << 20;  ///< a disk with less free space counts as full

/// Returns the folder of a file or, if that does not exist yet, the nearest folder above it that does.
std::filesystem::path folder_above(const std::filesystem::path& file)
{
    std::error_code ignored;
    std::filesystem::path folder = std::filesystem::absolute(file).lexically_normal().parent_path();
    while (folder.has_relative_path() && !std::filesystem::exists(folder, ignored)) folder = folder.parent_path();
    return folder;
}

/// Makes a file without a name there. Returns the error's number; 0: none. Permissions alone do not tell: root may
/// write everywhere except on a disk that is mounted read-only.
int error_of_new_file(const std::filesystem::path& folder)
{
    const FileDescriptor made(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
    if (made) return 0;
    const int error = errno;
    if (error == EACCES || error == EROFS || error == ENOSPC || error == EDQUOT || error == EPERM) return error;
    return ::access(folder.c_str(), W_OK | X_OK) == 0 ? 0 : errno;  // a file system without such files
}

}  // namespace

std::string why_not_savable(const std::filesystem::path& file)
{
    const std::filesystem::path folder = folder_above(file);
    const int error = error_of_new_file(folder);
    if (error == ENOSPC || error == EDQUOT) return sentence("the disk of ", folder.string(), " is full");
    if (error != 0) return sentence("the folder ", folder.string(), " cannot be written to: ", reason_of(error));
    struct statvfs status {};
    if (::statvfs(folder.c_str(), &status) != 0 || status.f_blocks == 0) return {};
    const bool is_full = uint64_t(status.f_bavail) * status.f_frsize < MIN_FREE_BYTES;
    return is_full ? sentence("the disk of ", folder.string(), " is full") : std::string();
}

}  // namespace shvr::ui
