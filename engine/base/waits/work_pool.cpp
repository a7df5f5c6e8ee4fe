#include "engine/base/waits/work_pool.h"

#include <algorithm>

#include "engine/base/waits/waits.h"

namespace shvr {

class WorkPool::Batch {
public:
    Task run;
    int64_t next = 0;     ///< the first task not yet started
    int64_t end = 0;      ///< tasks from this index on do not exist or were dropped
    int64_t running = 0;  ///< started but not finished
    std::exception_ptr failure;

    bool is_finished() const { return next >= end && running == 0; }
};

WorkPool::WorkPool(int threads, std::function<void()> poll, std::function<void()> before_task)
    : waits_are_over_(waits_of_this_thread()), poll_(std::move(poll)), before_task_(std::move(before_task))
{
    for (int worker = 0; worker < std::max(1, threads); ++worker) {
        threads_.emplace_back([this, worker] { work(worker); });
    }
}

WorkPool::~WorkPool()
{
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
        for (auto* queue : {&urgent_, &normal_}) {
            for (const auto& batch : *queue) batch->end = batch->next;
        }
    }
    begun_.notify_all();
    threads_.clear();
}

std::shared_ptr<WorkPool::Batch> WorkPool::start(int64_t tasks, Task run, Urgency urgency)
{
    auto batch = std::make_shared<Batch>();
    batch->run = std::move(run);
    batch->end = tasks;
    if (tasks > 0) {
        const std::lock_guard lock(mutex_);
        (urgency == Urgency::urgent ? urgent_ : normal_).push_back(batch);
    }
    begun_.notify_all();
    return batch;
}

void WorkPool::wait(const std::shared_ptr<Batch>& batch)
{
    std::unique_lock lock(mutex_);
    const auto is_finished = [&] { return batch->is_finished(); };
    for (;;) {
        if (!poll_) finished_.wait(lock, is_finished);
        // Measures the time since the last poll of any batch, so that a series of short batches is polled, too.
        const bool is_due = poll_ && std::chrono::steady_clock::now() >= polled_ + POLL_INTERVAL;
        if (!is_due && finished_.wait_until(lock, polled_ + POLL_INTERVAL, is_finished)) break;
        lock.unlock();
        std::exception_ptr failure;
        try {
            poll_();
        } catch (...) {
            failure = std::current_exception();
        }
        polled_ = std::chrono::steady_clock::now();
        lock.lock();
        if (!failure) continue;
        // Drops the tasks not yet started: once this call has failed, the caller may free what tasks use.
        batch->end = std::min(batch->end, batch->next);
        finished_.wait(lock, is_finished);
        std::rethrow_exception(failure);
    }
    if (batch->failure) std::rethrow_exception(batch->failure);
}

void WorkPool::work(int worker)
{
    const WaitsUntil waits(waits_are_over_);
    std::unique_lock lock(mutex_);
    for (;;) {
        begun_.wait(lock, [&] { return is_ending_ || !urgent_.empty() || !normal_.empty(); });
        if (is_ending_) return;
        std::deque<std::shared_ptr<Batch>>& queue = urgent_.empty() ? normal_ : urgent_;
        const std::shared_ptr<Batch> batch = queue.front();
        if (batch->next >= batch->end) {
            queue.pop_front();
            continue;
        }
        const int64_t task = batch->next++;
        ++batch->running;
        lock.unlock();
        std::exception_ptr failure;
        try {
            if (before_task_) before_task_();
            batch->run(task, worker);
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        --batch->running;
        if (failure) {
            if (!batch->failure) batch->failure = failure;
            batch->end = std::min(batch->end, batch->next);
        }
        if (batch->is_finished()) finished_.notify_all();
    }
}

}  // namespace shvr
