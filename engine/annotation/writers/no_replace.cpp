#include "engine/annotation/writers/no_replace.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

bool lacks_call(int error)
{
    return error == EINVAL || error == ENOSYS || error == ENOTSUP || error == EPERM || error == EMLINK;
}

[[noreturn]] void refuse(const fs::path& from, const fs::path& to, int error)
{
    fail(to.string(), ": cannot be written, to keep ", from.filename().string(), " there: ", reason_of(error));
}

/// For file systems with neither RENAME_NOREPLACE nor links: the name is taken by an empty file, and that is replaced.
bool rename_over_own(const fs::path& from, const fs::path& to)
{
    const FileDescriptor own(::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!own && errno == EEXIST) return false;
    if (!own || std::rename(from.c_str(), to.c_str()) != 0) refuse(from, to, errno);
    return true;
}

}  // namespace

bool link_to_free(const fs::path& from, const fs::path& to, int& error)
{
    error = ::link(from.c_str(), to.c_str()) == 0 ? 0 : errno;
    return error == 0;
}

bool rename_to_free(const fs::path& from, const fs::path& to)
{
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
    if (errno == EEXIST) return false;
    if (!lacks_call(errno)) refuse(from, to, errno);
    // Network file systems have no such flag.
    struct stat status {};
    if (::lstat(from.c_str(), &status) != 0) refuse(from, to, errno);
    if (S_ISDIR(status.st_mode)) {
        // A folder replaces at most an empty folder.
        if (std::rename(from.c_str(), to.c_str()) == 0) return true;
        if (errno == ENOTEMPTY || errno == EEXIST || errno == ENOTDIR) return false;
        refuse(from, to, errno);
    }
    int error = 0;
    if (link_to_free(from, to, error)) {
        if (::unlink(from.c_str()) != 0) refuse(from, to, errno);
        return true;
    }
    if (error == EEXIST) return false;
    if (!lacks_call(error)) refuse(from, to, error);
    return rename_over_own(from, to);
}

}  // namespace shvr
