#pragma once
// Ends long waits of a thread, such as those for a network, when its owner no longer wants the result. Code that waits
// asks `wait_is_over` every few milliseconds and throws `Stopped`. Any thread may call these.

#include <atomic>
#include <functional>

namespace shvr {

/// During its lifetime, waits of this thread end as soon as `is_over` returns true. Nested objects: each can end them.
class WaitsUntil {
public:
    explicit WaitsUntil(std::function<bool()> is_over);
    ~WaitsUntil();
    WaitsUntil(const WaitsUntil&) = delete;
    WaitsUntil& operator=(const WaitsUntil&) = delete;

private:
    friend bool wait_is_over();
    std::function<bool()> is_over_;
    const WaitsUntil* outer_;
};

/// Makes the waits of all threads end once `flag` is set. The flag must live until the program ends.
void end_all_waits_by(const std::atomic<bool>& flag);

bool wait_is_over();
/// Throws `Stopped` if waits are over.
void stop_if_wait_is_over();

}  // namespace shvr
