#pragma once
// Worker threads for long work that is cut into many small tasks. Tasks come in batches; a batch that is urgent goes
// before those that are not. The first exception of a batch drops the tasks of it that have not begun, and is thrown to
// whoever waits.
//
// One thread owns the pool: it starts batches and waits for them. A task may use everything that outlives its batch;
// `worker` (0 ... workers() - 1) tells which scratch memory is its own.

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

    /// `poll` is called every 50 ms by a thread that waits, for one batch or for many short ones; what it throws ends
    /// the batch that is waited for and is thrown on.
    /// `before_task` is called by workers before every task; what it throws is as if the task had thrown it.
    explicit WorkPool(int threads, std::function<void()> poll = {}, std::function<void()> before_task = {});
    /// Drops what has not begun, and waits for the rest.
    ~WorkPool();
    WorkPool(const WorkPool&) = delete;

    int workers() const { return static_cast<int>(threads_.size()); }

    enum class Urgency { normal, urgent };
    class Batch;
    std::shared_ptr<Batch> start(int64_t tasks, Task run, Urgency urgency = Urgency::normal);
    void wait(const std::shared_ptr<Batch>& batch);
    /// Both.
    void run(int64_t tasks, Task run, Urgency urgency = Urgency::urgent)
    {
        wait(start(tasks, std::move(run), urgency));
    }

private:
    void work(int worker);

    static constexpr std::chrono::milliseconds POLL_INTERVAL{50};

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
