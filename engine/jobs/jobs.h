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
// Everything except a job's function and `Options::wake` is called on the main thread, and only wait() and the
// destructor wait for the worker. Functions and completions are destroyed on the main thread, so they may own objects
// of that thread. Both threads use the queues and each job's progress, under one lock, and an atomic flag for each
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
    /// The work of a job, which runs on the worker and reports its progress often. A report throws `Stopped` once the
    /// job is cancelled. The returned completion may be empty.
    using Function = std::function<Completion(ProgressReporter&)>;

    struct Options {
        std::function<void()> wake{};       ///< called on the worker when a job has ended, e.g. to wake the main loop
        std::function<double()> seconds{};  ///< time since any fixed moment, callable from any thread; empty:
                                            ///< a steady clock
        Number first = 1;                   ///< number of the first job, so that several workers can use distinct ones
    };
    Jobs();
    explicit Jobs(Options options);
    /// Cancels all jobs and waits for the running one. No more completions run.
    ~Jobs();
    Jobs(const Jobs&) = delete;

    /// Adds a job to the queue. `what` is its title for lists and messages, as in "exporting stem.swc".
    Number start(std::string what, Function function);
    /// Cancels a job. If it waits, it never starts; if it runs, it ends at its next progress report. Its completion
    /// does not run, even if its function completes. An unknown number, or that of a job that has ended, is ignored.
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
    /// Returns the running job, then the waiting jobs in order, without jobs that have ended.
    std::vector<State> states() const;
    /// Whether everything is done: no job is running or waiting, and no completion remains to be run.
    bool is_idle() const;

    struct Finished {
        Number number = 0;
        std::string what;
        std::string failure;  ///< message of an exception from the function or its completion; empty: no exception, or
                              ///< only `Stopped`
        bool was_cancelled = false;
        bool is_done() const { return failure.empty() && !was_cancelled; }
    };
    /// Runs the completions of the jobs that have ended since the last call, in order. Returns these jobs. Completions
    /// may start and cancel jobs.
    std::vector<Finished> finish();
    /// Waits until all jobs have ended, and runs their completions. For tests, and before the program ends.
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
