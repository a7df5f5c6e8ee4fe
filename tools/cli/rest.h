#pragma once
// Loops that advance a workbench until nothing is left to do.

#include <chrono>
#include <cstdint>
#include <thread>

namespace shvr::cli {

/// Sleeps in some turns of such a loop: otherwise the loop would keep cores busy on which a software device draws.
inline void rest(uint64_t turn)
{
    constexpr uint64_t TURNS_AT_ONCE = 8;  // rare, so that work of many turns that never waits takes no longer
    if (turn % TURNS_AT_ONCE == TURNS_AT_ONCE - 1) std::this_thread::sleep_for(std::chrono::microseconds(200));
}

}  // namespace shvr::cli
