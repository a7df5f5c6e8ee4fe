// A disk that does not answer, as a network that is gone: loaded before the C library (LD_PRELOAD), it holds every call
// about a path with "/hung/" in it, or that ends in "/hung", until the file SHVR_HUNG_UNTIL is there. Such calls of the
// main thread are counted in the file SHVR_HUNG_LOG, one line each, and are not held, so that a test that fails ends.
// SHVR_HUNG_PATH: only paths with that text in them. SHVR_HUNG_REMOVALS: only fsync and unlink are held, and unlink in
// the main thread as well, where only signal handlers call it.

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

template <class Function>
Function* next(const char* name)
{
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool is_there(const char* path)
{
    return path && syscall(SYS_faccessat, AT_FDCWD, path, F_OK) == 0;
}

bool is_hung(const char* path)
{
    if (!path) return false;
    if (const char* const only = std::getenv("SHVR_HUNG_PATH")) return std::strstr(path, only);
    const size_t length = std::strlen(path);
    return std::strstr(path, "/hung/") || (length >= 5 && std::strcmp(path + length - 5, "/hung") == 0);
}

void meet(const char* path, const char* call)
{
    if (!is_hung(path)) return;
    const char* const until = std::getenv("SHVR_HUNG_UNTIL");
    const bool has_removals = std::getenv("SHVR_HUNG_REMOVALS"), is_removal = std::strcmp(call, "unlink") == 0;
    if (has_removals && !is_removal && std::strcmp(call, "fsync") != 0) return;
    const bool is_held = has_removals && is_removal;
    if (syscall(SYS_gettid) == getpid() && !is_held) {
        const char* const log = std::getenv("SHVR_HUNG_LOG");
        const long file = log ? syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND, 0600) : -1;
        if (file < 0) return;
        char line[512];
        const int length = std::snprintf(line, sizeof line, "%s %s\n", call, path);
        static_cast<void>(!write(int(file), line, size_t(length)));
        close(int(file));
        return;
    }
    while (!is_there(until)) usleep(20'000);
}

}  // namespace

extern "C" {

int stat(const char* path, struct stat* found)
{
    meet(path, "stat");
    return next<int(const char*, struct stat*)>("stat")(path, found);
}

int lstat(const char* path, struct stat* found)
{
    meet(path, "lstat");
    return next<int(const char*, struct stat*)>("lstat")(path, found);
}

int access(const char* path, int mode)
{
    meet(path, "access");
    return next<int(const char*, int)>("access")(path, mode);
}

int unlink(const char* path)
{
    meet(path, "unlink");
    return next<int(const char*)>("unlink")(path);
}

int fsync(int file)
{
    char link[64], path[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length > 0) {
        path[length] = '\0';
        meet(path, "fsync");
    }
    return next<int(int)>("fsync")(file);
}

DIR* opendir(const char* path)
{
    meet(path, "opendir");
    return next<DIR*(const char*)>("opendir")(path);
}

int openat(int folder, const char* path, int flags, ...)
{
    va_list more;
    va_start(more, flags);
    const auto mode = va_arg(more, mode_t);
    va_end(more);
    meet(path, "openat");
    return next<int(int, const char*, int, ...)>("openat")(folder, path, flags, mode);
}

int open(const char* path, int flags, ...)
{
    va_list more;
    va_start(more, flags);
    const auto mode = va_arg(more, mode_t);
    va_end(more);
    meet(path, "open");
    return next<int(const char*, int, ...)>("open")(path, flags, mode);
}
}
