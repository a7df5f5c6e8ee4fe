#include "tests/fuzz/replay/watch.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>

#include <fcntl.h>
#include <sanitizer/common_interface_defs.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>

/// From the sanitizers' allocator_interface.h: g++ ships the functions, but not the header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*, size_t),
                                                         void (*free_hook)(const volatile void*));
extern "C" size_t __sanitizer_get_allocated_size(const volatile void* memory);

/// SHVR_CHECK and uncaught exceptions abort; the sanitizer then prints the stack and calls back.
extern "C" const char* __asan_default_options()
{
    return "handle_abort=1:detect_leaks=1:allocator_may_return_null=0:max_allocation_size_mb=4096";
}

namespace shvr::fuzz {
namespace {

// Allocations come from any thread, and from before main.
std::atomic<int64_t> live_bytes{0}, peak_bytes{0}, max_bytes{INT64_MAX};

std::string watched_target, watched_name;  // NOLINT: read when the program ends
std::span<const uint8_t> watched_input;
bool is_watching = false;
int64_t bytes_before = 0;
double seconds_before = 0.0;

void on_malloc(const volatile void* /*memory*/, size_t bytes)
{
    const int64_t live = live_bytes.fetch_add(int64_t(bytes)) + int64_t(bytes);
    if (live > peak_bytes.load()) peak_bytes.store(live);
    if (live > max_bytes.load()) {
        max_bytes.store(INT64_MAX);
        std::fprintf(stderr, "FINDING: the input takes more than its share of memory, with %zu bytes at once\n", bytes);
        std::abort();
    }
}

void on_free(const volatile void* memory)
{
    if (memory == nullptr) return;
    live_bytes.fetch_sub(int64_t(__sanitizer_get_allocated_size(memory)));
}

void keep_input()
{
    if (!is_watching) return;
    is_watching = false;
    max_bytes.store(INT64_MAX);
    ::mkdir("build", 0777);
    ::mkdir("build/fuzz", 0777);
    const std::string path = "build/fuzz/finding-" + watched_target;
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    const bool is_kept = file >= 0 && ::write(file, watched_input.data(), watched_input.size()) >= 0;
    std::fprintf(stderr, "%s: %s is a finding%s%s\n", watched_target.c_str(), watched_name.c_str(),
                 is_kept ? "; it is kept in " : "", is_kept ? path.c_str() : "");
}

void on_time_over(int /*signal*/)
{
    static constexpr char TEXT[] = "FINDING: the input takes too long\n";
    static_cast<void>(!::write(2, TEXT, sizeof(TEXT) - 1));
    std::abort();
}

double processor_seconds()
{
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

void set_timer(int seconds)
{
    const itimerval timer{{0, 0}, {seconds, 0}};
    ::setitimer(ITIMER_PROF, &timer, nullptr);
}

void install()
{
    static bool is_installed = false;
    if (is_installed) return;
    is_installed = true;
    __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
    __sanitizer_set_death_callback(keep_input);
    std::signal(SIGPROF, on_time_over);
}

}  // namespace

void begin_watch(const std::string& target, const std::string& input_name, std::span<const uint8_t> input,
                 const Limits& limits)
{
    install();
    watched_target = target;
    watched_name = input_name;
    watched_input = input;
    set_timer(limits.max_seconds);
    seconds_before = processor_seconds();
    bytes_before = live_bytes.load();
    peak_bytes.store(bytes_before);
    max_bytes.store(bytes_before + limits.max_bytes);
    is_watching = true;
}

Watched end_watch()
{
    is_watching = false;
    max_bytes.store(INT64_MAX);
    set_timer(0);
    return {peak_bytes.load() - bytes_before, processor_seconds() - seconds_before};
}

}  // namespace shvr::fuzz
