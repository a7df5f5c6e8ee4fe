// A file system whose locks do not work, loaded before the C library (LD_PRELOAD). SHVR_LOCKS, read at each call:
// ENOSYS, ENOLCK or ENOTSUP is the reason for which every lock is refused; with "hollow" every lock is granted, also a
// second one; with "files" files that are open for writing can be locked, and nothing else, as on NFS. SHVR_HOST is the
// name of the computer.

#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace {

template <class Function>
Function* next(const char* name)
{
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

enum class Locks { work, fail, are_hollow, of_files };

/// Sets errno if they fail.
Locks locks()
{
    const char* const chosen = std::getenv("SHVR_LOCKS");
    if (!chosen || !*chosen) return Locks::work;
    if (std::strcmp(chosen, "hollow") == 0) return Locks::are_hollow;
    if (std::strcmp(chosen, "files") == 0) return Locks::of_files;
    errno = std::strcmp(chosen, "ENOSYS") == 0 ? ENOSYS : std::strcmp(chosen, "ENOLCK") == 0 ? ENOLCK : ENOTSUP;
    return Locks::fail;
}

bool is_about_locks(int command)
{
    for (const int known : std::array{F_SETLK, F_SETLKW, F_GETLK, F_OFD_SETLK, F_OFD_SETLKW, F_OFD_GETLK})
        if (command == known) return true;
    return false;
}

int call(const char* name, int file, int command, void* argument)
{
    const Locks how = is_about_locks(command) ? locks() : Locks::work;
    if (how == Locks::work || how == Locks::of_files) return next<int(int, int, ...)>(name)(file, command, argument);
    if (how == Locks::fail) return -1;
    if (command == F_GETLK || command == F_OFD_GETLK) static_cast<struct flock*>(argument)->l_type = F_UNLCK;
    return 0;
}

}  // namespace

extern "C" {

/// By its presence a test knows that this library is loaded.
int shvr_locks_can_fail = 1;

int fcntl(int file, int command, ...)
{
    va_list more;
    va_start(more, command);
    void* const argument = va_arg(more, void*);
    va_end(more);
    return call("fcntl", file, command, argument);
}

int fcntl64(int file, int command, ...)
{
    va_list more;
    va_start(more, command);
    void* const argument = va_arg(more, void*);
    va_end(more);
    return call("fcntl64", file, command, argument);
}

int flock(int file, int operation) noexcept
{
    const Locks how = locks();
    if (how == Locks::of_files && (next<int(int, int, ...)>("fcntl")(file, F_GETFL, 0) & O_ACCMODE) == O_RDONLY) {
        errno = EBADF;
        return -1;
    }
    if (how == Locks::work || how == Locks::of_files) return next<int(int, int)>("flock")(file, operation);
    return how == Locks::fail ? -1 : 0;
}

int gethostname(char* name, size_t size) noexcept
{
    const char* const chosen = std::getenv("SHVR_HOST");
    if (!chosen) return next<int(char*, size_t)>("gethostname")(name, size);
    std::strncpy(name, chosen, size);
    return 0;
}
}
