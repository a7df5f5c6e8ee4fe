#pragma once
// The time of day in logs of actions. Any thread.

#include <cstdint>
#include <string>

namespace shvr {

/// Milliseconds since 1970-01-01 00:00 UTC, without leap seconds. Jumps when the system clock is set.
int64_t wall_clock_ms();

/// ISO 8601 with milliseconds: "2026-11-29T01:33:25.120Z". Years from 0 to 9999; other times are clamped.
std::string utc_text(int64_t time_ms);

/// Adds the key "time" to a line of a script or log; readers of scripts and logs accept and ignore this key.
std::string with_time(std::string line, int64_t time_ms);

}  // namespace shvr
