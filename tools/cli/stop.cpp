#include "tools/cli/stop.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <ctime>

#include "engine/base/atomic_writer.h"
#include "engine/base/waits/unfinished_work.h"
#include "engine/base/waits/waits.h"
#include "tools/cli/stop_deadline.h"

namespace shvr::cli {

namespace {

std::atomic<bool> command_listens = false, is_requested = false, is_ending = false;
std::atomic<int> first_signal = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

/// Timer that ends the process if it is still running at a deadline after the request; `deadline` is 0 if there is
/// none. A timer needs no thread, so it works even while the main thread waits for a driver that does not answer.
timer_t overdue_timer;
itimerspec deadline{};

bool has_deadline()
{
    return deadline.it_value.tv_sec > 0 || deadline.it_value.tv_nsec > 0;
}

constexpr int HANDLED[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};

/// Prints a message, unless standard error is a full pipe: writing would block, and the process must end.
void say(const char* text)
{
    pollfd standard_error{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
    if (::poll(&standard_error, 1, 0) == 1) static_cast<void>(::write(STDERR_FILENO, text, std::strlen(text)) > 0);
}

const char* name_of(int signal_number)
{
    return signal_number == SIGINT ? "Ctrl-C" : signal_number == SIGTERM ? "SIGTERM" : "SIGHUP";
}

/// Ends the sentence with what remains on the disk all the same, as a folder from which an import goes on.
void say_what_is_left()
{
    name_unfinished_work([](const char* words) {
        say("; ");
        say(words);
    });
    say("\n");
}

/// Ends the process by the signal itself, so that the parent process sees the signal, and a shell's loop ends, too.
void end_by(int signal_number)
{
    std::signal(signal_number, SIG_DFL);
    sigset_t only_it;
    sigemptyset(&only_it);
    sigaddset(&only_it, signal_number);
    ::pthread_sigmask(SIG_UNBLOCK, &only_it, nullptr);
    ::raise(signal_number);
}

/// Calls only async-signal-safe functions.
extern "C" void stop(int signal_number)
{
    int none = 0;
    first_signal.compare_exchange_strong(none, signal_number);
    if (signal_number != SIGPIPE && command_listens && !is_requested.exchange(true)) {
        if (has_deadline()) ::timer_settime(overdue_timer, 0, &deadline, nullptr);
        return;
    }
    remove_temporary_files();
    // After SIGPIPE nothing is printed: the reader of the output is gone, and standard error may be the same pipe.
    if (signal_number != SIGPIPE) {
        say("shvr: stopped by ");
        say(name_of(signal_number));
        say("; no file is left half written");
        say_what_is_left();
    }
    end_by(signal_number);
}

/// Calls only async-signal-safe functions. Where removing files hangs, too, as on a network disk that is gone, the
/// timer ends the process in another thread.
extern "C" void end_overdue(int)
{
    constexpr itimerspec AGAIN{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_nsec = 200'000'000}};
    const int signal_number = first_signal;
    if (is_ending.exchange(true)) return end_by(signal_number);
    say("shvr: stopped by ");
    say(name_of(signal_number));
    say(" before everything had ended; no file is left half written, and the next opening continues from the journal");
    say_what_is_left();
    ::timer_settime(overdue_timer, 0, &AGAIN, nullptr);
    remove_temporary_files();
    end_by(signal_number);
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
        // A signal that the parent process had ignored, as shells do for background jobs, stays ignored.
        if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler == SIG_IGN) continue;
        struct sigaction action {};
        action.sa_handler = stop;
        sigemptyset(&action.sa_mask);
        ::sigaction(number, &action, nullptr);
    }
}

StopRequest::StopRequest()
{
    end_all_waits_by(is_requested);
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

StopDeadline::StopDeadline(std::chrono::milliseconds most)
{
    sigevent at_deadline{};
    at_deadline.sigev_notify = SIGEV_SIGNAL;
    at_deadline.sigev_signo = SIGALRM;
    if (::timer_create(CLOCK_MONOTONIC, &at_deadline, &overdue_timer) != 0) return;  // then it may hang, as without
    std::signal(SIGALRM, end_overdue);
    deadline.it_value = {.tv_sec = most.count() / 1000, .tv_nsec = most.count() % 1000 * 1'000'000};
}

StopDeadline::~StopDeadline()
{
    if (!has_deadline()) return;
    deadline = {};
    ::timer_delete(overdue_timer);
}

}  // namespace shvr::cli
