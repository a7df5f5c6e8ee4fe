#include "engine/jobs/jobs.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <new>
#include <system_error>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"

namespace shvr {
namespace {

double steady_seconds()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Estimates the time left from the present fraction and the fraction `seconds` ago; below 0: unknown.
double estimate_left(double first_fraction, double fraction, double seconds)
{
    const double gone = fraction - first_fraction;
    return first_fraction >= 0.0 && gone > 0.0 ? std::max(0.0, (1.0 - fraction) / gone * seconds) : -1.0;
}

/// Returns the message of the exception being handled. `what` is the title of the job that threw it.
std::string failure_in_words(const std::string& what)
{
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return "host memory is exhausted while " + what + "; expected more, or a smaller --budget-host";
    } catch (const std::system_error& error) {
        if (error.code() != std::errc::resource_unavailable_try_again) return error.what();
        return sentence("no further thread can be started while ", what, " (", error.what(),
                        "); expected a higher limit of processes (ulimit -u), or fewer threads: --threads 1");
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "an error of an unknown kind";
    }
}

}  // namespace

/// A job. `function`, `number` and `what` stay unchanged once the worker sees it; the lock guards all other members.
struct Jobs::Job {
    Number number = 0;
    std::string what;
    Function function;
    std::atomic<bool> is_cancelled = false;

    std::string stretch, detail;
    double fraction = -1.0, first_fraction = -1.0, seconds_left = -1.0;
    double begun = 0.0, stretch_begun = 0.0;

    Completion completion;
    std::string failure;
};

class Jobs::Reporter final : public ProgressReporter {
public:
    Reporter(Jobs& jobs, Job& job) : jobs_(jobs), job_(job) {}

    Progress begin(const std::string& what) override
    {
        stop_where_cancelled();
        const std::scoped_lock lock(jobs_.mutex_);
        job_.stretch = what;
        job_.detail.clear();
        job_.fraction = job_.first_fraction = job_.seconds_left = -1.0;
        job_.stretch_begun = jobs_.seconds_();
        return [this](double fraction) { show(fraction, {}, -1.0); };
    }

    void show(double fraction, const std::string& detail, double left) override
    {
        stop_where_cancelled();
        const std::scoped_lock lock(jobs_.mutex_);
        if (job_.first_fraction < 0.0) job_.first_fraction = fraction;
        job_.fraction = fraction < 0.0 ? -1.0 : std::min(fraction, 1.0);
        job_.detail = detail;
        const double seconds = jobs_.seconds_() - job_.stretch_begun;
        job_.seconds_left = left >= 0.0 ? left : estimate_left(job_.first_fraction, fraction, seconds);
    }

    const std::atomic<bool>& stop_requested() const override { return job_.is_cancelled; }

private:
    void stop_where_cancelled() const
    {
        if (job_.is_cancelled) throw Stopped(job_.what + ": cancelled; no file is left half written");
    }
    Jobs& jobs_;
    Job& job_;
};

Jobs::Jobs() : Jobs(Options{}) {}

Jobs::Jobs(Options options)
    : wake_(std::move(options.wake)),
      seconds_(options.seconds ? std::move(options.seconds) : steady_seconds),
      next_(options.first)
{}

Jobs::~Jobs()
{
    cancel_all();
    {
        const std::scoped_lock lock(mutex_);
        is_closing_ = true;
    }
    changed_.notify_all();
    if (worker_.joinable()) worker_.join();
}

Jobs::Number Jobs::start(std::string what, Function function)
{
    if (!worker_.joinable()) worker_ = std::thread([this] { work(); });
    auto job = std::make_unique<Job>();
    job->what = std::move(what);
    job->function = std::move(function);
    Number number = 0;
    {
        const std::scoped_lock lock(mutex_);
        number = job->number = next_++;
        waiting_.push_back(std::move(job));
    }
    changed_.notify_all();
    return number;
}

void Jobs::cancel(Number number)
{
    const std::scoped_lock lock(mutex_);
    const auto is_meant = [number](const std::unique_ptr<Job>& job) { return job && job->number == number; };
    if (is_meant(running_)) running_->is_cancelled = true;
    for (const std::unique_ptr<Job>& job : ended_)
        if (is_meant(job)) job->is_cancelled = true;
    const auto found = std::ranges::find_if(waiting_, is_meant);
    if (found == waiting_.end()) return;
    (*found)->is_cancelled = true;
    ended_.push_back(std::move(*found));
    waiting_.erase(found);
    changed_.notify_all();
}

void Jobs::cancel_all()
{
    const std::scoped_lock lock(mutex_);
    if (running_) running_->is_cancelled = true;
    for (std::unique_ptr<Job>& job : waiting_) ended_.push_back(std::move(job));
    waiting_.clear();
    for (const std::unique_ptr<Job>& job : ended_) job->is_cancelled = true;
    changed_.notify_all();
}

void Jobs::work()
{
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return is_closing_ || !waiting_.empty(); });
        if (is_closing_) return;
        running_ = std::move(waiting_.front());
        waiting_.pop_front();
        Job& job = *running_;  // needs no lock: only this thread moves or destroys a running job
        job.begun = job.stretch_begun = seconds_();
        Reporter reporter(*this, job);
        lock.unlock();
        std::string failure;
        Completion completion;
        try {
            const WaitsUntil waits([&job] { return job.is_cancelled.load(); });
            completion = job.function(reporter);
        } catch (const Stopped& stopped) {
            if (!job.is_cancelled) failure = stopped.what();
        } catch (...) {
            failure = failure_in_words(job.what);
        }
        lock.lock();
        job.completion = std::move(completion);
        job.failure = std::move(failure);
        ended_.push_back(std::move(running_));
        changed_.notify_all();
        if (!wake_) continue;
        lock.unlock();
        wake_();
        lock.lock();
    }
}

Jobs::State Jobs::state_of(const Job& job) const
{
    const bool is_waiting = &job != running_.get();
    return {.number = job.number,
            .what = job.what,
            .stretch = job.stretch,
            .detail = job.detail,
            .fraction = job.fraction,
            .seconds = is_waiting ? 0.0 : seconds_() - job.begun,
            .seconds_left = job.seconds_left,
            .is_waiting = is_waiting,
            .is_cancelled = job.is_cancelled};
}

std::vector<Jobs::State> Jobs::states() const
{
    const std::scoped_lock lock(mutex_);
    std::vector<State> states;
    if (running_) states.push_back(state_of(*running_));
    for (const std::unique_ptr<Job>& job : waiting_) states.push_back(state_of(*job));
    return states;
}

bool Jobs::is_idle() const
{
    const std::scoped_lock lock(mutex_);
    return !running_ && waiting_.empty() && ended_.empty();
}

std::vector<Jobs::Finished> Jobs::finish()
{
    std::vector<Finished> finished;
    for (;;) {
        std::unique_ptr<Job> job;
        {
            const std::scoped_lock lock(mutex_);
            if (ended_.empty()) return finished;
            job = std::move(ended_.front());
            ended_.pop_front();
        }
        Finished& told = finished.emplace_back();
        told = {job->number, job->what, job->failure, job->is_cancelled};
        if (!told.is_done() || !job->completion) continue;
        try {
            job->completion();
        } catch (...) {
            told.failure = failure_in_words(job->what);
        }
    }
}

std::vector<Jobs::Finished> Jobs::wait()
{
    std::vector<Finished> all;
    for (;;) {
        for (Finished& each : finish()) all.push_back(std::move(each));
        std::unique_lock lock(mutex_);
        if (!running_ && waiting_.empty() && ended_.empty()) return all;
        changed_.wait(lock, [&] { return !ended_.empty(); });
    }
}

}  // namespace shvr
