#include "tests/gpu/workbench/slow_disk.h"

#include <cerrno>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <system_error>
#include <thread>

// The linker's names.
extern "C" {
int __real_fsync(int file);
int __real_fdatasync(int file);
int __real_rename(const char* from, const char* to);
}

namespace shvr::test {

namespace {

struct State {
    std::mutex mutex;
    std::condition_variable changed;
    bool is_watched = false;
    std::thread::id watcher;
    std::string stops_at, refused_at;
    int error_number = 0;
    int of_watcher = 0, of_others = 0, waiting = 0;
};
State state;

std::string path_of(int file)
{
    std::error_code error;
    return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file), error).string();
}

/// 0: the call is to be made; otherwise the errno that it fails with.
int met(const std::string& path)
{
    std::unique_lock lock(state.mutex);
    if (!state.is_watched) return 0;
    ++(std::this_thread::get_id() == state.watcher ? state.of_watcher : state.of_others);
    if (!state.refused_at.empty() && path.ends_with(state.refused_at)) return state.error_number;
    const auto stops = [&] { return !state.stops_at.empty() && path.ends_with(state.stops_at); };
    if (std::this_thread::get_id() == state.watcher || !stops()) return 0;
    ++state.waiting;
    state.changed.wait(lock, [&] { return !stops(); });
    --state.waiting;
    return 0;
}

}  // namespace

SlowDisk::SlowDisk()
{
    const std::scoped_lock lock(state.mutex);
    state.is_watched = true;
    state.watcher = std::this_thread::get_id();
    state.of_watcher = state.of_others = 0;
}

SlowDisk::~SlowDisk()
{
    go_on();
    const std::scoped_lock lock(state.mutex);
    state.is_watched = false;
}

void SlowDisk::stop_at(const std::string& ending)
{
    const std::scoped_lock lock(state.mutex);
    state.stops_at = ending;
}

void SlowDisk::refuse_at(const std::string& ending, int error_number)
{
    const std::scoped_lock lock(state.mutex);
    state.refused_at = ending;
    state.error_number = error_number;
}

void SlowDisk::go_on()
{
    {
        const std::scoped_lock lock(state.mutex);
        state.stops_at.clear();
        state.refused_at.clear();
    }
    state.changed.notify_all();
}

bool SlowDisk::is_waited_for() const
{
    const std::scoped_lock lock(state.mutex);
    return state.waiting > 0;
}

int SlowDisk::calls_of_this_thread() const
{
    const std::scoped_lock lock(state.mutex);
    return state.of_watcher;
}

int SlowDisk::calls_of_others() const
{
    const std::scoped_lock lock(state.mutex);
    return state.of_others;
}

}  // namespace shvr::test

extern "C" {

int __wrap_fsync(int file)
{
    if (const int error = shvr::test::met(shvr::test::path_of(file)); error != 0) return errno = error, -1;
    return __real_fsync(file);
}

int __wrap_fdatasync(int file)
{
    if (const int error = shvr::test::met(shvr::test::path_of(file)); error != 0) return errno = error, -1;
    return __real_fdatasync(file);
}

int __wrap_rename(const char* from, const char* to)
{
    if (const int error = shvr::test::met(to); error != 0) return errno = error, -1;
    return __real_rename(from, to);
}
}
