#pragma once
// Long work beside the loop: on one worker thread, one job after the other in the order of `start`. A job makes its
// result on the worker; what is done with it, the completion, runs on the main thread.
//
//   jobs.start("exporting stem.swc", [snapshot, task](ProgressReporter& reporter) -> Jobs::Completion {
//       ExportResult result = run(task, snapshot->view(), reporter);
//       return [&window, result] { window.say(result); };
//   });
//   ...
//   for (const Jobs::Finished& job : jobs.finish()) window.say(job);    // once a turn
//
// Everything but a job's function and `wake` is called on the main thread, and nothing here waits for the worker except
// `wait` and the destructor. Functions and completions are destroyed on the main thread, so they may hold what belongs
// to it. Shared between the threads, all under one lock: the queues, and how far each job is; and one atomic flag for
// each job.

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
    using Number = uint64_t;  ///< ascending, in the order of `start`
    using Completion = std::function<void()>;
    /// Runs on the worker, tells the reporter often, and so throws `Stopped` once it is cancelled. The completion may
    /// be empty.
    using Function = std::function<Completion(ProgressReporter&)>;

    struct Options {
        std::function<void()> wake{};       ///< called on the worker when a job has ended: to wake a loop that sleeps
        std::function<double()> seconds{};  ///< since any moment, from any thread; empty: a steady clock
        Number first = 1;                   ///< so that numbers of several workers differ
    };
    Jobs();
    explicit Jobs(Options options);
    /// Cancels all jobs and waits for the one that runs. No completion runs any more.
    ~Jobs();
    Jobs(const Jobs&) = delete;

    /// `what`: for lists and messages, as in "exporting stem.swc".
    Number start(std::string what, Function function);
    /// A job that waits does not begin; one that runs ends at its next step. Its completion will not run, even if its
    /// function came to its end. A number that is unknown or finished is ignored.
    void cancel(Number number);
    void cancel_all();

    struct State {
        Number number = 0;
        std::string what;
        std::string stretch;         ///< which part of the work is under way, as in "writing stem.swc"; may be empty
        std::string detail;          ///< as in "120 MB/s"; may be empty
        double fraction = -1.0;      ///< of the stretch; below 0: not known
        double seconds = 0.0;        ///< since it began to run
        double seconds_left = -1.0;  ///< of the stretch; below 0: not known
        bool is_waiting = false;
        bool is_cancelled = false;
    };
    /// The job that runs, then those that wait, in order. Jobs that have ended are not among them.
    std::vector<State> states() const;
    /// Nothing runs, waits, or is to be finished.
    bool is_idle() const;

    struct Finished {
        Number number = 0;
        std::string what;
        std::string failure;  ///< what the function or its completion threw, in words; empty: nothing but `Stopped`
        bool was_cancelled = false;
        bool is_done() const { return failure.empty() && !was_cancelled; }
    };
    /// Runs the completions of what has ended since, in order, and tells what ended. A completion may start and cancel
    /// jobs.
    std::vector<Finished> finish();
    /// Finishes until nothing is left, in tests and before the program ends.
    std::vector<Finished> wait();

private:
    struct Job;
    class Reporter;
    void work();
    State state_of(const Job& job) const;

    std::function<void()> wake_;
    std::function<double()> seconds_;

    mutable std::mutex mutex_;  ///< of all that follows, but for the thread
    std::condition_variable changed_;
    bool is_closing_ = false;
    Number next_ = 1;
    std::deque<std::unique_ptr<Job>> waiting_;
    std::unique_ptr<Job> running_;
    std::deque<std::unique_ptr<Job>> ended_;

    std::thread worker_;  ///< begins with the first job
};

}  // namespace shvr
