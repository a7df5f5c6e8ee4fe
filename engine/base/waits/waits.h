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
    friend std::function<bool()> waits_of_this_thread();
    std::function<bool()> is_over_;
    const WaitsUntil* outer_;
};

/// Returns a function that states whether waits of this thread are over. Threads that work on its behalf pass it to a
/// WaitsUntil of their own. It must not be called after the objects that this thread's conditions use are gone.
std::function<bool()> waits_of_this_thread();

/// Makes the waits of all threads end once `flag` is set. The flag must live until the program ends.
void end_all_waits_by(const std::atomic<bool>& flag);

bool wait_is_over();
/// Throws `Stopped` if waits are over.
void stop_if_wait_is_over();

}  // namespace shvr
