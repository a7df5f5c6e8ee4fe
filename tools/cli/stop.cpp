#include "tools/cli/stop.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "engine/base/atomic_writer.h"

namespace shvr::cli {

namespace {

std::atomic<bool> command_listens = false, is_requested = false;
std::atomic<int> first_signal = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

/// After SIGPIPE, nothing is printed: the reader has left, and standard error may be the same pipe.
constexpr int HANDLED[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

/// Calls only async-signal-safe functions.
extern "C" void stop(int signal_number)
{
    int none = 0;
    first_signal.compare_exchange_strong(none, signal_number);
    if (signal_number != SIGPIPE && command_listens && !is_requested.exchange(true)) return;
    remove_temporary_files();
    const char* const text = signal_number == SIGINT    ? "shvr: stopped by Ctrl-C; no file is left half written\n"
                             : signal_number == SIGTERM ? "shvr: stopped by SIGTERM; no file is left half written\n"
                             : signal_number == SIGHUP  ? "shvr: stopped by SIGHUP; no file is left half written\n"
                                                        : "";
    static_cast<void>(::write(STDERR_FILENO, text, std::strlen(text)) > 0);
    // Ends the process by the signal itself, so that the parent process sees it and a shell's loop ends, too.
    std::signal(signal_number, SIG_DFL);
    ::raise(signal_number);
}

}  // namespace

void open_standard_streams()
{
    int descriptor = 0;
    do descriptor = ::open("/dev/null", O_RDWR);
    while (descriptor >= 0 && descriptor <= STDERR_FILENO);
    if (descriptor > STDERR_FILENO) ::close(descriptor);
}

void end_in_words()
{
    for (const int number : HANDLED) {
        struct sigaction now {};
        // A signal that the parent process ignores stays ignored, as for background jobs.
        if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler == SIG_IGN) continue;
        struct sigaction action {};
        action.sa_handler = stop;
        sigemptyset(&action.sa_mask);
        ::sigaction(number, &action, nullptr);
    }
}

StopRequest::StopRequest()
{
    command_listens = true;
}

StopRequest::~StopRequest()
{
    command_listens = false;
}

const std::atomic<bool>& StopRequest::flag()
{
    return is_requested;
}

const char* StopRequest::in_words()
{
    return first_signal == SIGTERM  ? "stopped by SIGTERM"
           : first_signal == SIGHUP ? "stopped by SIGHUP"
                                    : "stopped by Ctrl-C";
}

}  // namespace shvr::cli
