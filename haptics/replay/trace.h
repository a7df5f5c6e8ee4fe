#pragma once
// A stylus trace: what a device answered and what a person chose, tick by tick, as a file (README.md has the format).
// What is read is what was written, bit for bit. Version 3, which ends with a hash of itself; versions 1 and 2, which
// do not, are read as well. Any thread.

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/force.h"
#include "haptics/replay/trace_relevance.h"

namespace shvr {

/// What a person chose, from a tick on. The threshold is for whoever makes the relevance.
struct TraceSettings {
    ForceSettings force;
    double threshold = 0.0;  ///< intensity
    size_t from_tick = 0;
};

struct TraceTick {
    uint64_t now_ns = 0;  ///< the servo's clock
    ReadResult read = ReadResult::fresh;
    DeviceState state;
    std::optional<glm::dvec3> force_n;  ///< what the servo wrote
    uint64_t relevance_time_ns = 0;     ///< up to which the relevance in use was known to be true; 0: there was none
};

/// Limits of the device from a tick on, where they changed.
struct TraceCaps {
    DeviceCaps caps;
    size_t from_tick = 0;
};

struct Trace {
    std::string unit;  ///< of physical lengths; empty: not known
    uint32_t rate_hz = 1000;
    DeviceCaps caps;
    std::vector<TraceCaps> later_caps;  ///< by tick
    /// Ticks from which another device, or the same one opened anew, answers a servo that starts anew: it has no force,
    /// no object, and feels nothing before the next relevance.
    std::vector<size_t> swaps;
    std::vector<TraceSettings> settings;  ///< by tick; the first one holds from the start
    /// The ticks tell what the servo felt: `relevance`, by tick, and nothing before the first. Otherwise whoever
    /// replays them makes it.
    bool holds_relevance = false;
    std::vector<TraceRelevance> relevance;
    std::vector<TraceTick> ticks;
};

inline constexpr std::string_view TRACE_READS[] = {"fresh", "stale", "lost", "malformed"};  ///< by ReadResult
inline constexpr int64_t MAX_TRACE_BYTES = int64_t{1} << 30;
inline constexpr size_t MAX_TRACE_TICKS = 4'000'000;  ///< more than an hour

/// `origin` names the text in errors: one sentence with line, key, value and what was expected.
Trace parse_trace(const std::string& text, const std::string& origin);
Trace read_trace(const std::filesystem::path& file);
std::string text_of(const Trace& trace);
/// Whole or not at all.
void write_trace(const std::filesystem::path& file, const Trace& trace);

}  // namespace shvr
