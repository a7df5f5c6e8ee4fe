#pragma once
// A stylus trace: the device's answers and the user's settings, tick by tick, as a file (README.md has the format).
// Reading returns exactly the written values, bit for bit. Writes version 3, which ends with a hash of the text; also
// reads versions 1 and 2, which have no hash. Any thread.

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/force.h"
#include "haptics/replay/trace_relevance.h"

namespace shvr {

/// The user's settings from a tick on. The threshold is for code that recomputes the relevance.
struct TraceSettings {
    ForceSettings force;
    double threshold = 0.0;  ///< intensity
    size_t from_tick = 0;
    bool operator==(const TraceSettings&) const = default;
};

struct TraceTick {
    uint64_t now_ns = 0;  ///< the servo's clock
    ReadResult read = ReadResult::fresh;
    DeviceState state;
    std::optional<glm::dvec3> force_n;  ///< what the servo wrote
    uint64_t relevance_time_ns = 0;     ///< time up to which the relevance in use was known to be valid; 0: there was
                                        ///< none
};

/// The device's limits from a tick on, after they changed.
struct TraceCaps {
    DeviceCaps caps;
    size_t from_tick = 0;
};

struct Trace {
    std::string unit;  ///< of physical lengths; empty: not known
    uint32_t rate_hz = 1000;
    DeviceCaps caps;
    std::vector<TraceCaps> later_caps;  ///< sorted by tick
    /// Ticks at which a restarted servo begins with another device, or with the same one reopened. The restarted servo
    /// has no force and no object, and feels nothing before the next relevance.
    std::vector<size_t> swaps;
    std::vector<TraceSettings> settings;  ///< sorted by tick; the first one applies from the start
    /// Whether the trace contains the relevance that the servo used: `relevance`, sorted by tick, none before the first
    /// entry. If false, the code that replays the trace recomputes relevance.
    bool holds_relevance = false;
    std::vector<TraceRelevance> relevance;
    /// Whether recomputed relevance is limited to the voxels that the session's settings show. False in traces of older
    /// versions, in which hidden voxels were felt, too.
    bool feels_seen = false;
    std::vector<TraceTick> ticks;
};

inline constexpr std::string_view TRACE_READS[] = {"fresh", "stale", "lost", "malformed"};  ///< by ReadResult
inline constexpr int64_t MAX_TRACE_BYTES = int64_t{1} << 30;
inline constexpr size_t MAX_TRACE_TICKS = 4'000'000;  ///< more than an hour

/// `origin` names the text in error messages: one sentence with line, key, value found and value expected.
Trace parse_trace(const std::string& text, const std::string& origin);
Trace read_trace(const std::filesystem::path& file);
std::string text_of(const Trace& trace);
/// Writes the file atomically.
void write_trace(const std::filesystem::path& file, const Trace& trace);

}  // namespace shvr
