#pragma once
// Loops that advance a workbench until nothing is left to do.

#include <chrono>
#include <cstdint>
#include <thread>

namespace shvr::cli {

/// Sleeps in some turns of such a loop, which would otherwise occupy cores that a software device needs to draw.
inline void rest(uint64_t turn)
{
    constexpr uint64_t TURNS_AT_ONCE = 8;  // sleeps are rare, so as not to slow down work that never waits
    if (turn % TURNS_AT_ONCE == TURNS_AT_ONCE - 1) std::this_thread::sleep_for(std::chrono::microseconds(200));
}

}  // namespace shvr::cli
