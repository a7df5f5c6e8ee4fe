#include "tests/durability/watched_calls.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <mutex>
#include <utility>

// The linker's names.
extern "C" {
int __real_open(const char* path, int flags, ...);
ssize_t __real_write(int file, const void* bytes, size_t count);
ssize_t __real_pwrite(int file, const void* bytes, size_t count, off_t at);
int __real_ftruncate(int file, off_t size);
int __real_rename(const char* from, const char* to);
int __real_renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags);
int __real_mkdir(const char* path, mode_t mode);
int __real_link(const char* from, const char* to);
int __real_unlink(const char* path);
}

namespace shvr::test {

namespace {

namespace fs = std::filesystem;

// Guards these against calls in flight.
std::mutex mutex;
std::string watched_folder, refused_folder;
std::vector<FileCall> calls;
Refusal refusal;

bool is_below(const std::string& path, const std::string& folder)
{
    return !folder.empty() && path.starts_with(folder);
}

std::string path_of(int file)
{
    std::error_code error;
    return fs::read_symlink("/proc/self/fd/" + std::to_string(file), error).string();
}

std::string absolute(const char* path)
{
    std::error_code error;
    return fs::absolute(path, error).lexically_normal().string();
}

/// Refuses the call, or makes and records it.
template <class Make>
auto made(FileCall call, const Make& make) -> decltype(make(0))
{
    const std::scoped_lock lock(mutex);
    const int error = refusal && is_below(call.path, refused_folder) ? refusal(call) : 0;
    if (error > 0) {
        errno = error;
        return -1;
    }
    const auto result = make(error);
    if (result < 0 || !is_below(call.path, watched_folder)) return result;
    if (call.kind == FileCall::Kind::write) call.bytes.resize(size_t(result));
    calls.push_back(std::move(call));
    return result;
}

FileCall write_call(int file, const void* bytes, size_t count, uint64_t at)
{
    const auto* const begin = static_cast<const std::byte*>(bytes);
    return {FileCall::Kind::write, path_of(file), {}, at, {begin, begin + count}};
}

/// Does not really sync: these tests do not depend on the real disk, and a machine manages only a few hundred syncs a
/// second.
int sync_call(int file)
{
    const std::string path = path_of(file);
    std::error_code error;
    const bool is_folder = fs::is_directory(path, error);
    return made({is_folder ? FileCall::Kind::sync_folder : FileCall::Kind::sync, path, {}, 0, {}},
                [](int) { return 0; });
}

}  // namespace

void watch(const fs::path& folder)
{
    const std::scoped_lock lock(mutex);
    watched_folder = fs::absolute(folder).string();
    calls.clear();
}

void note(uint64_t number)
{
    const std::scoped_lock lock(mutex);
    calls.push_back({FileCall::Kind::note, {}, {}, number, {}});
}

std::vector<FileCall> stop_watching()
{
    const std::scoped_lock lock(mutex);
    watched_folder.clear();
    return std::exchange(calls, {});
}

void refuse_calls(const fs::path& folder, Refusal refuses)
{
    const std::scoped_lock lock(mutex);
    refused_folder = fs::absolute(folder).string();
    refusal = std::move(refuses);
}

}  // namespace shvr::test

using namespace shvr::test;

extern "C" {

int __wrap_open(const char* path, int flags, ...)
{
    mode_t mode = 0;
    if ((flags & O_CREAT) != 0) {
        va_list arguments;
        va_start(arguments, flags);
        mode = mode_t(va_arg(arguments, unsigned));
        va_end(arguments);
    }
    std::error_code error;
    const std::string whole = absolute(path);
    if ((flags & O_CREAT) == 0 || std::filesystem::exists(whole, error)) return __real_open(path, flags, mode);
    return made({FileCall::Kind::create, whole, {}, 0, {}}, [&](int) { return __real_open(path, flags, mode); });
}

ssize_t __wrap_write(int file, const void* bytes, size_t count)
{
    const off_t at = ::lseek(file, 0, SEEK_CUR);
    return made(write_call(file, bytes, count, uint64_t(at < 0 ? 0 : at)),
                [&](int error) { return __real_write(file, bytes, error == SHORT_WRITE ? (count + 1) / 2 : count); });
}

ssize_t __wrap_pwrite(int file, const void* bytes, size_t count, off_t at)
{
    return made(write_call(file, bytes, count, uint64_t(at)), [&](int error) {
        return __real_pwrite(file, bytes, error == SHORT_WRITE ? (count + 1) / 2 : count, at);
    });
}

int __wrap_fsync(int file)
{
    return sync_call(file);
}

int __wrap_fdatasync(int file)
{
    return sync_call(file);
}

int __wrap_ftruncate(int file, off_t size)
{
    return made({FileCall::Kind::truncate, path_of(file), {}, uint64_t(size), {}},
                [&](int) { return __real_ftruncate(file, size); });
}

int __wrap_rename(const char* from, const char* to)
{
    return made({FileCall::Kind::rename, absolute(from), absolute(to), 0, {}},
                [&](int) { return __real_rename(from, to); });
}

/// Relative to no folder, which is all that the program uses.
int __wrap_renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags)
{
    return made({(flags & RENAME_EXCHANGE) != 0 ? FileCall::Kind::exchange : FileCall::Kind::rename,
                 absolute(from),
                 absolute(to),
                 flags,
                 {}},
                [&](int) { return __real_renameat2(from_folder, from, to_folder, to, flags); });
}

int __wrap_mkdir(const char* path, mode_t mode)
{
    return made({FileCall::Kind::make_folder, absolute(path), {}, 0, {}},
                [&](int) { return __real_mkdir(path, mode); });
}

/// Of the whole file system, not really made, as `sync_call`.
int __wrap_syncfs(int file)
{
    return made({FileCall::Kind::sync_all, path_of(file), {}, 0, {}}, [](int) { return 0; });
}

int __wrap_link(const char* from, const char* to)
{
    return made({FileCall::Kind::link, absolute(from), absolute(to), 0, {}},
                [&](int) { return __real_link(from, to); });
}

int __wrap_unlink(const char* path)
{
    return made({FileCall::Kind::unlink, absolute(path), {}, 0, {}}, [&](int) { return __real_unlink(path); });
}

}  // extern "C"
