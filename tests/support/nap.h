#pragma once
// Loops of tests that ask a device again and again whether it has finished.

#include <chrono>
#include <thread>

namespace shvr::test {

/// Sleeps in some turns of a loop that polls: lavapipe draws on the cores that polling would keep busy.
inline void nap(int turn)
{
    constexpr int TURNS_AT_ONCE = 8;  // so that what a caller does in many turns without waiting takes no longer
    if (turn % TURNS_AT_ONCE == TURNS_AT_ONCE - 1) std::this_thread::sleep_for(std::chrono::microseconds(200));
}

}  // namespace shvr::test
