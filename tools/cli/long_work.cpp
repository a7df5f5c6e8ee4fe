#include "tools/cli/long_work.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "engine/base/text.h"

namespace shvr::cli {

namespace {

/// Interval at which the progress line's time is updated while the work reports nothing.
constexpr std::chrono::milliseconds TICK{250};

double seconds_now()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Shows the progress line; a thread of its own keeps the time up to date.
class Shown {
public:
    Shown()
        : line_({::isatty(STDERR_FILENO) == 1, [](const std::string& text) { std::cerr << text << std::flush; },
                 seconds_now}),
          ticker_([this](const std::stop_token& stop) { tick(stop); })
    {}
    ~Shown()
    {
        ticker_.request_stop();
        ticker_.join();
        clear();
    }

    void begin(const std::string& what)
    {
        const std::scoped_lock lock(mutex_);
        line_.begin(what);
        is_busy_ = true;
        fraction_ = seconds_left_ = -1.0;
        detail_.clear();
    }
    void show(double fraction, const std::string& detail, double seconds_left)
    {
        const std::scoped_lock lock(mutex_);
        is_busy_ = true;
        fraction_ = fraction;
        detail_ = detail;
        seconds_left_ = seconds_left;
        line_.show(fraction, detail, seconds_left);
    }
    void clear()
    {
        const std::scoped_lock lock(mutex_);
        is_busy_ = false;
        line_.clear();
    }
    void print(const std::string& text)
    {
        const std::scoped_lock lock(mutex_);
        line_.clear();
        std::cerr << text << '\n';
    }

private:
    void tick(const std::stop_token& stop)
    {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
            if (is_busy_) line_.show(fraction_, detail_, seconds_left_);
            stopped_.wait_for(lock, stop, TICK, [] { return false; });
        }
    }

    std::mutex mutex_;
    std::condition_variable_any stopped_;
    ProgressLine line_;
    bool is_busy_ = false;
    double fraction_ = -1.0, seconds_left_ = -1.0;  ///< below 0: unknown
    std::string detail_;
    std::jthread ticker_;  ///< declared last, so that it stops before the members that it uses are destroyed
};

std::string last_what;
std::unique_ptr<Shown> shown;  ///< progress line of the running LongWork; null if the work is quiet

}  // namespace

LongWork::LongWork(bool quiet)
{
    std::signal(SIGXFSZ, SIG_IGN);  // so that exceeding the file size limit is an error, like a full disk
    if (!quiet) shown = std::make_unique<Shown>();
}

LongWork::~LongWork()
{
    shown.reset();
}

Progress LongWork::begin(const std::string& what)
{
    stop_if_asked();
    last_what = what;
    if (shown) shown->begin(printable(what));
    return [this](double fraction) {
        stop_if_asked();
        if (shown) shown->show(fraction, {}, -1.0);
    };
}

void LongWork::show(double fraction, const std::string& detail, double seconds_left)
{
    if (shown) shown->show(fraction, detail, seconds_left);
}

void LongWork::stop_if_asked() const
{
    if (is_asked_to_stop()) throw Stopped(sentence(StopRequest::in_words(), "; no file is left half written"));
}

std::string last_begun()
{
    return last_what;
}

int64_t peak_mebibytes()
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024;
}

void clear_progress()
{
    if (shown) shown->clear();
}

void print_beside_progress(const std::string& line)
{
    const std::string safe = printable(line);
    if (shown)
        shown->print(safe);
    else
        std::cerr << safe << '\n';
}

}  // namespace shvr::cli
