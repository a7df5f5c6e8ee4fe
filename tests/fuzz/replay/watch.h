#pragma once
// Watches one input at a time: its memory, in any library, its time, and how the program ends. When the program ends
// during an input (a sanitizer's report, an exception, a limit), the input is written to finding-TARGET in the working
// folder's build/fuzz and named on stderr. One thread.

#include <cstdint>
#include <span>
#include <string>

namespace shvr::fuzz {

struct Limits {
    int64_t max_bytes = int64_t{64} << 20;  ///< peak memory while one input is read
    int max_seconds = 5;                    ///< of processor time
};

/// Begins an input, which lasts until `end_watch`.
void begin_watch(const std::string& target, const std::string& input_name, std::span<const uint8_t> input,
                 const Limits& limits);
struct Watched {
    int64_t peak_bytes = 0;  ///< above the level before the input
    double seconds = 0.0;    ///< of processor time
};
Watched end_watch();

}  // namespace shvr::fuzz
