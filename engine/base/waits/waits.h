#pragma once
// Ends long waits of a thread, such as waits for a network, once the result is no longer wanted. Waiting code calls
// `wait_is_over` every few milliseconds, and throws `Stopped` if it returns true. Any thread may call these functions.

#include <atomic>
#include <functional>

namespace shvr {

/// While this object exists, waits of this thread end once `is_over` returns true. Of nested objects, any can end them.
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
