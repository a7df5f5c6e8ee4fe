#pragma once
// Runs long work in the background, on one worker thread, one job after the other in the order of `start`. A job
// computes its result on the worker; its completion, which uses the result, runs on the main thread.
//
//   jobs.start("exporting stem.swc", [snapshot, task](ProgressReporter& reporter) -> Jobs::Completion {
//       ExportResult result = run(task, snapshot->view(), reporter);
//       return [&window, result] { window.say(result); };
//   });
//   ...
//   for (const Jobs::Finished& job : jobs.finish()) window.say(job);    // once per frame
//
// Everything but a job's function and `wake` is called on the main thread, and nothing here waits for the worker
// except `wait` and the destructor. Functions and completions are destroyed on the main thread, so they may own objects
// of that thread. The threads share the queues and each job's progress, both under one lock, and an atomic flag per
// job.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "engine/jobs/progress_reporter.h"

namespace shvr {

class Jobs {
public:
    using Number = uint64_t;  ///< job numbers ascend in the order of `start`
    using Completion = std::function<void()>;
    /// Runs on the worker and reports progress often; a report throws `Stopped` once the job is cancelled. The returned
    /// completion may be empty.
    using Function = std::function<Completion(ProgressReporter&)>;

    struct Options {
        std::function<void()> wake{};       ///< called on the worker when a job has ended, to wake a sleeping loop
        std::function<double()> seconds{};  ///< time since any fixed moment, callable from any thread; empty:
                                            ///< a steady clock
        Number first = 1;                   ///< number of the first job; lets several workers use distinct numbers
    };
    Jobs();
    explicit Jobs(Options options);
    /// Cancels all jobs and waits for the running one. No completions run after this.
    ~Jobs();
    Jobs(const Jobs&) = delete;

    /// `what`: the job's title for lists and messages, as in "exporting stem.swc".
    Number start(std::string what, Function function);
    /// A waiting job will not start; a running job ends at its next progress report. The job's completion will not run,
    /// even if its function completes. An unknown or finished number is ignored.
    void cancel(Number number);
    void cancel_all();

    struct State {
        Number number = 0;
        std::string what;
        std::string stretch;         ///< the current stage of the work, as in "writing stem.swc"; may be empty
        std::string detail;          ///< e.g. "120 MB/s"; may be empty
        double fraction = -1.0;      ///< progress of the current stage; below 0: unknown
        double seconds = 0.0;        ///< time since the job began to run
        double seconds_left = -1.0;  ///< estimate for the current stage; below 0: unknown
        bool is_waiting = false;
        bool is_cancelled = false;
    };
    /// The running job, then the waiting jobs in order. Jobs that have ended are not included.
    std::vector<State> states() const;
    /// Whether all is done: no job is running or waiting, and no ended job's completion is still to run.
    bool is_idle() const;

    struct Finished {
        Number number = 0;
        std::string what;
        std::string failure;  ///< message of an exception from the function or its completion; empty if none, or only
                              ///< `Stopped`
        bool was_cancelled = false;
        bool is_done() const { return failure.empty() && !was_cancelled; }
    };
    /// Runs the completions of jobs that have ended since the last call, in order, and returns those jobs. A completion
    /// may start and cancel jobs.
    std::vector<Finished> finish();
    /// Waits until no job is left, and finishes all of them. For tests, and before the program ends.
    std::vector<Finished> wait();

private:
    struct Job;
    class Reporter;
    void work();
    State state_of(const Job& job) const;

    std::function<void()> wake_;
    std::function<double()> seconds_;

    mutable std::mutex mutex_;  ///< guards all of the following members except the thread
    std::condition_variable changed_;
    bool is_closing_ = false;
    Number next_ = 1;
    std::deque<std::unique_ptr<Job>> waiting_;
    std::unique_ptr<Job> running_;
    std::deque<std::unique_ptr<Job>> ended_;

    std::thread worker_;  ///< started by the first job
};

}  // namespace shvr
