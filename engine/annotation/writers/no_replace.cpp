#include "engine/annotation/writers/no_replace.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <span>
#include <vector>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

bool lacks_call(int error)
{
    return error == EINVAL || error == ENOSYS || error == ENOTSUP || error == EPERM || error == EMLINK;
}

/// The outcome of a call that failed.
Renaming after_failure(const fs::path& from, const fs::path& to, int error)
{
    struct stat status {};
    if (error == EEXIST) return Renaming::name_taken;
    if (error == ENOENT && ::lstat(from.c_str(), &status) != 0 && errno == ENOENT) return Renaming::gone;
    fail(to.string(), ": cannot be written, to keep ", from.filename().string(), " there: ", reason_of(error));
}

/// Reserves `to` with an empty file, then renames over it. Use only if no other process moves files away from `to`.
Renaming rename_over_own(const fs::path& from, const fs::path& to)
{
    const FileDescriptor own(::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!own) return after_failure(from, to, errno);
    if (std::rename(from.c_str(), to.c_str()) == 0) return Renaming::done;
    const int error = errno;
    ::unlink(to.c_str());
    return after_failure(from, to, error);
}

/// 0, or errno.
int rename_without_replacing(const fs::path& from, const fs::path& to)
{
    return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0 ? 0 : errno;
}

/// Copies a file to `to`, a name that only this process uses.
void copy_to_own(const fs::path& from, const fs::path& to)
{
    const FileDescriptor input(::open(from.c_str(), O_RDONLY | O_CLOEXEC));
    if (!input) fail(from.string(), ": cannot be read: ", reason_of(errno));
    AtomicWriter writer(to);
    std::vector<std::byte> piece(size_t{1} << 20);
    for (;;) {
        const ssize_t count = ::read(input.number(), piece.data(), piece.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(from.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) break;
        writer.append(std::span(piece).first(size_t(count)));
    }
    writer.commit();
}

}  // namespace

Renaming move_to_free(const fs::path& from, const fs::path& to)
{
    const int error = rename_without_replacing(from, to);
    if (error == 0) return Renaming::done;
    if (!lacks_call(error)) return after_failure(from, to, error);
    // Network file systems have no RENAME_NOREPLACE. link(2) and then unlink(2) would not be safe: between the two
    // calls, another process may put another file at `from`.
    struct stat status {};
    if (::lstat(from.c_str(), &status) != 0) return after_failure(from, to, errno);
    if (!S_ISDIR(status.st_mode)) return rename_over_own(from, to);
    // Renaming a folder can replace only an empty folder, so nothing is lost.
    if (std::rename(from.c_str(), to.c_str()) == 0) return Renaming::done;
    if (errno == ENOTEMPTY || errno == ENOTDIR) return Renaming::name_taken;
    return after_failure(from, to, errno);
}

Renaming link_to_free(const fs::path& from, const fs::path& to)
{
    const fs::path file = link_target(from);
    const int error = ::link(file.c_str(), to.c_str()) == 0 ? 0 : errno;
    if (error == 0) return Renaming::done;
    if (!lacks_call(error) && error != EXDEV) return after_failure(from, to, error);
    const FileDescriptor reserved(::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!reserved) return after_failure(from, to, errno);
    try {
        copy_to_own(file, to);
    } catch (...) {
        ::unlink(to.c_str());
        throw;
    }
    return Renaming::done;
}

Renaming put_at_free(const fs::path& own, const fs::path& to)
{
    int error = rename_without_replacing(own, to);
    if (error == 0) return Renaming::done;
    if (!lacks_call(error)) return after_failure(own, to, error);
    // Links, instead of renaming over an empty placeholder: another process may already have moved the placeholder and
    // put its own file in its place.
    error = ::link(own.c_str(), to.c_str()) == 0 ? 0 : errno;
    if (error == 0) {
        ::unlink(own.c_str());  // no more than a second name
        return Renaming::done;
    }
    return lacks_call(error) ? rename_over_own(own, to) : after_failure(own, to, error);
}

}  // namespace shvr
