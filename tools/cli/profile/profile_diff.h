#pragma once
// Compares two profiles: of frames, or of a session of work (`--script`). JSON in, JSON out.

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

/// A duration as measured repeatedly in one run.
struct Timing {
    double median = 0.0;
    std::optional<double> noise;  ///< null if there were too few measurements (tools/report/noise.h)
};

/// Returns PREFIXmin_ms, PREFIXmedian_ms and PREFIXp95_ms of `object`, which were measured `count` times. Null if these
/// keys hold no times. Fails, naming the file, if they are not numbers.
std::optional<Timing> timing_of(const Json& object, const std::string& prefix, size_t count, const std::string& file);

/// Returns {name, a_ms, b_ms, delta_ms, ratio, noise_ms, verdict}. The verdict is "faster" or "slower" beyond the
/// noise, "same" within the noise, and "unknown" if the noise is not known.
Json compared_times(const std::string& name, const std::optional<Timing>& a, const std::optional<Timing>& b);
/// Returns the counters that both profiles have: {name, a, b, delta}.
Json compared_counts(const Json& a, const Json& b);
/// Compares the section "bytes" of both profiles: {name, a, b, delta}.
Json compared_memory(const Json& a, const Json& b);

/// `object[key]`, which must be a number.
double number_at(const Json& object, const char* key, const std::string& file);

/// Compare two profiles of sessions with the same script: {"replays", "actions", "session", "counters", "memory"}.
bool is_of_session(const Json& summary);
Json session_difference_of(const Json& a, const std::string& a_name, const Json& b, const std::string& b_name);
std::string session_difference_text(const Json& difference);

/// Return the table row for a comparison of times, and for a comparison of counts.
std::vector<std::string> time_row(const Json& row);
std::vector<std::string> count_row(const Json& row);
/// Returns an explanation of the verdict "unknown" if one of the rows has that verdict; otherwise empty.
std::string note_on_unknown(const std::vector<const Json*>& lists);

}  // namespace shvr::cli
