#pragma once
// For loops that advance a workbench until no work is left.

#include <chrono>
#include <cstdint>
#include <thread>

namespace shvr::cli {

/// Sleeps in some iterations of a loop: a loop without sleep would occupy cores that a software device draws with.
inline void rest(uint64_t turn)
{
    constexpr uint64_t TURNS_AT_ONCE = 8;  // sleeps rarely, so that work that never waits is not slowed down
    if (turn % TURNS_AT_ONCE == TURNS_AT_ONCE - 1) std::this_thread::sleep_for(std::chrono::microseconds(200));
}

}  // namespace shvr::cli
