#pragma once
// Time limits and numbers of attempts of requests, from the environment: SHVR_REMOTE_CONNECT_S, SHVR_REMOTE_STALL_S and
// SHVR_REMOTE_TOTAL_S, in seconds, and SHVR_REMOTE_TRIES. Any thread may call this.

#include <cstdint>

namespace shvr {

struct Deadlines {
    double connect_s = 15.0;  ///< for name, connection and TLS
    double stall_s = 20.0;    ///< without STALL_BYTES_PER_S on average
    double total_s = 600.0;   ///< for one request
    int64_t tries = 5;        ///< maximum number of attempts, if failures may be temporary
};
/// A transfer that is slower counts as stalled.
inline constexpr int64_t STALL_BYTES_PER_S = 256;

/// Reads the environment once. Fails if a variable is not a number within its limits.
const Deadlines& deadlines();

}  // namespace shvr
