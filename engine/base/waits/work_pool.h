#pragma once
// Worker threads for long work that is split into many small tasks. Tasks come in batches; urgent batches run before
// others. The first exception in a batch drops its tasks that have not started, and is rethrown in the waiting thread.
//
// One thread owns the pool: it starts batches and waits for them. A task may use anything that outlives its batch;
// `worker` (0 ... workers() - 1) selects its own scratch memory. Waits of tasks (waits/waits.h) end when waits of the
// thread that made the pool are over.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace shvr {

class WorkPool {
public:
    using Task = std::function<void(int64_t task, int worker)>;

    /// The waiting thread calls `poll` every 50 ms, whether it waits for one long batch or for many short ones. If
    /// `poll` throws, the current batch ends and the exception is rethrown. Workers call `before_task` before every
    /// task; an exception from `before_task` counts as an exception from the task.
    explicit WorkPool(int threads, std::function<void()> poll = {}, std::function<void()> before_task = {});
    /// Drops tasks that have not started, and waits for the rest.
    ~WorkPool();
    WorkPool(const WorkPool&) = delete;

    int workers() const { return int(threads_.size()); }

    enum class Urgency { normal, urgent };
    class Batch;
    std::shared_ptr<Batch> start(int64_t tasks, Task run, Urgency urgency = Urgency::normal);
    void wait(const std::shared_ptr<Batch>& batch);
    /// Starts a batch and waits for it.
    void run(int64_t tasks, Task run, Urgency urgency = Urgency::urgent)
    {
        wait(start(tasks, std::move(run), urgency));
    }

private:
    void work(int worker);

    static constexpr std::chrono::milliseconds POLL_INTERVAL{50};

    std::function<bool()> waits_are_over_;  ///< whether waits of the thread that made the pool are over
    std::function<void()> poll_;
    std::function<void()> before_task_;
    std::chrono::steady_clock::time_point polled_ = std::chrono::steady_clock::now();
    std::mutex mutex_;
    std::condition_variable begun_, finished_;
    std::deque<std::shared_ptr<Batch>> urgent_, normal_;
    bool is_ending_ = false;
    std::vector<std::jthread> threads_;
};

}  // namespace shvr
